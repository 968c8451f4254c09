//! Compares model ids and names.
//!
//! In: ids and names. Out: whether they match. Case and the separators between words do not count, so
//! `Qwen/Qwen3-VL-8B` contains the words of `qwen3-vl`.

/// Returns the words of an id: runs of letters and digits, in lower case.
fn words(name: &str) -> Vec<String> {
    name.split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect()
}

/// Returns whether an id contains the words of a family's name, one after the other.
pub(super) fn holds(id: &str, part: &str) -> bool {
    let (id, part) = (words(id), words(part));
    !part.is_empty() && id.windows(part.len()).any(|window| window == part)
}

/// Returns whether an id is a name with its words joined, such as `claude-opus-5-5` for Claude Opus 5.5, optionally
/// followed by a date.
pub(super) fn spells(id: &str, name: &str) -> bool {
    let (id, name) = (words(id), words(name));
    id.strip_prefix(name.as_slice()).is_some_and(|rest| {
        rest.iter().all(|word| is_number(word)) && (rest.is_empty() || has_date(rest))
    })
}

/// Returns whether an id contains a date: some word of it is a number of four digits or more.
pub(super) fn is_dated(id: &str) -> bool {
    has_date(&words(id))
}

fn has_date(words: &[String]) -> bool {
    words.iter().any(|word| word.len() >= 4 && is_number(word))
}

fn is_number(word: &str) -> bool {
    word.bytes().all(|byte| byte.is_ascii_digit())
}

/// Returns an id without the prefixes of gateways, nested ones too; case does not count.
pub(super) fn without_prefixes<'i>(id: &'i str, prefixes: &[&str]) -> &'i str {
    let mut left = id;
    // Each turn shortens the id, so this ends.
    while let Some(shorter) = prefixes
        .iter()
        .filter_map(|prefix| {
            let start = left.get(..prefix.len())?;
            (start.eq_ignore_ascii_case(prefix) && !prefix.is_empty())
                .then(|| &left[prefix.len()..])
        })
        .min_by_key(|rest| rest.len())
        .filter(|rest| !rest.is_empty())
    {
        left = shorter;
    }
    left
}

/// Returns whether an id matches an alias, which may end in `*` as a wildcard.
pub(super) fn is_alias(id: &str, alias: &str) -> bool {
    match alias.strip_suffix('*') {
        Some(start) => id.starts_with(start),
        None => id == alias,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_family_is_found_by_whole_words() {
        for id in [
            "qwen3-vl:8b",
            "Qwen/Qwen3-VL-8B-Instruct",
            "unsloth/qwen3_vl",
        ] {
            assert!(holds(id, "qwen3-vl"), "{id}");
        }
        assert!(holds("qwen2.5vl:7b", "qwen2.5vl"));
        for (id, part) in [
            ("qwen2.5-vl", "qwen2-vl"),
            ("molmo2-8b", "molmo"),
            ("qwen3", "qwen3-vl"),
            ("x", ""),
        ] {
            assert!(!holds(id, part), "{id} {part}");
        }
    }

    #[test]
    fn a_name_may_be_spelt_as_ids_are_with_a_date_after_it() {
        for id in [
            "claude-opus-5-5",
            "Claude-Opus-5.5",
            "claude-opus-5-5-20260901",
        ] {
            assert!(spells(id, "Claude Opus 5.5"), "{id}");
        }
        for id in [
            "claude-opus-5",
            "claude-opus-5-5-1",
            "claude-opus-5-5-fast",
            "",
            "opus-5-5",
        ] {
            assert!(!spells(id, "Claude Opus 5.5"), "{id}");
        }
    }

    #[test]
    fn prefixes_of_gateways_are_left_out_however_they_nest() {
        let prefixes = [
            "openrouter/",
            "openai/",
            "bedrock/",
            "bedrock/converse/",
            "us.",
            "anthropic.",
        ];
        for (id, expected) in [
            ("openrouter/openai/gpt-6.2-sol", "gpt-6.2-sol"),
            ("OpenRouter/qwen/qwen3-vl-8b", "qwen/qwen3-vl-8b"),
            (
                "bedrock/converse/us.anthropic.claude-opus-5-5",
                "claude-opus-5-5",
            ),
            ("openai-community/gpt2", "openai-community/gpt2"),
            ("openai/", "openai/"),
            ("é", "é"),
            ("", ""),
        ] {
            assert_eq!(without_prefixes(id, &prefixes), expected, "{id}");
        }
    }

    #[test]
    fn dates_are_seen_in_ids_as_vendors_write_them() {
        for id in [
            "gpt-4o-2024-08-06",
            "claude-3-5-sonnet-20241022",
            "gpt-4-0613",
            "gemini-2.5-flash-preview-09-2025",
        ] {
            assert!(is_dated(id), "{id}");
        }
        for id in ["gpt-6.2-sol", "gpt-4o", "gemini-4-argon", ""] {
            assert!(!is_dated(id), "{id}");
        }
    }
}
