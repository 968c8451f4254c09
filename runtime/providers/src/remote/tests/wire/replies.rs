//! Tests of replies: answers with their usage, and every named failure.

use super::*;
use proptest::prelude::*;
use serde_json::json;

/// Replies with the answer `fold it`: 30 input tokens, 10 of them cached, and 12 output tokens; and the hidden tokens that
/// each reports.
const ANSWERS: &[(Wire, &str, Option<u64>)] = &[
    (
        Wire::OpenaiChat,
        r#"{"choices":[{"finish_reason":"stop","message":{"role":"assistant","content":"fold it","refusal":null,"tool_calls":null}}],
        "usage":{"prompt_tokens":30,"completion_tokens":12,"prompt_tokens_details":{"cached_tokens":10},"completion_tokens_details":{"reasoning_tokens":5}}}"#,
        Some(5),
    ),
    (
        Wire::OpenaiChat,
        r#"{"choices":[{"message":{"content":[{"type":"text","text":"fold "},{"type":"text","text":"it"}]}}],
        "usage":{"prompt_tokens":30,"completion_tokens":12,"prompt_tokens_details":{"cached_tokens":10}}}"#,
        None,
    ),
    (
        Wire::OpenaiResponses,
        r#"{"status":"completed","error":null,"output":[{"type":"reasoning","summary":[]},{"type":"message","content":[
        {"type":"output_text","text":"fold "},{"type":"something_new"},{"type":"output_text","text":"it"}]}],
        "usage":{"input_tokens":30,"input_tokens_details":{"cached_tokens":10},"output_tokens":12,"output_tokens_details":{"reasoning_tokens":5}}}"#,
        Some(5),
    ),
    (
        Wire::Anthropic,
        r#"{"content":[{"type":"thinking","thinking":"hm","signature":""},{"type":"text","text":"fold it"}],"stop_reason":"end_turn",
        "usage":{"input_tokens":15,"cache_creation_input_tokens":5,"cache_read_input_tokens":10,"output_tokens":12}}"#,
        None,
    ),
    (
        Wire::Gemini,
        r#"{"candidates":[{"content":{"role":"model","parts":[{"text":"hm","thought":true},{"text":"fold it"}]},"finishReason":"STOP"}],
        "usageMetadata":{"promptTokenCount":30,"cachedContentTokenCount":10,"candidatesTokenCount":7,"thoughtsTokenCount":5}}"#,
        Some(5),
    ),
    (
        Wire::Anthropic,
        r#"{"content":[{"type":"text","text":"fold it"}],"stop_reason":"end_turn","usage":{"input_tokens":20,
        "cache_read_input_tokens":10,"output_tokens":12,"output_tokens_details":{"thinking_tokens":5}}}"#,
        Some(5),
    ),
];

#[test]
fn answers_are_read_with_what_they_used() {
    for (wire, reply, reasoning_tokens) in ANSWERS {
        let usage = Usage {
            input_tokens: 30,
            cached_input_tokens: 10,
            output_tokens: 12,
            reasoning_tokens: *reasoning_tokens,
        };
        let expected = Answer {
            text: "fold it".to_owned(),
            usage: Some(usage),
        };
        assert_eq!(wire.decode(reply.as_bytes()), Ok(expected), "{reply}");
    }
}

#[test]
fn hidden_tokens_that_are_counted_beside_the_answer_are_added_to_it() {
    for (output, hidden, total, expected) in [
        // Within the answer, as OpenAI counts.
        (12, Some(5), Some(42), 12),
        (12, Some(12), None, 12),
        (12, None, Some(42), 12),
        (12, Some(0), Some(42), 12),
        // Beside it, as the sum or the numbers themselves show.
        (12, Some(5), Some(47), 17),
        (12, Some(500), None, 512),
        (12, Some(500), Some(42), 512),
        (u64::MAX, Some(u64::MAX), None, u64::MAX),
    ] {
        let fields = |[input, answer]: [&str; 2]| {
            json!({ input: 30, answer: output, format!("{answer}_details"): { "reasoning_tokens": hidden },
                "total_tokens": total })
        };
        let chat = json!({ "choices": [{ "message": { "content": "fold it" } }],
            "usage": fields(["prompt_tokens", "completion_tokens"]) });
        let responses = json!({ "output": [{ "type": "message", "content": [{ "type": "output_text", "text": "fold it" }] }],
            "usage": fields(["input_tokens", "output_tokens"]) });
        for (wire, reply) in [(Wire::OpenaiChat, chat), (Wire::OpenaiResponses, responses)] {
            let answer = wire
                .decode(reply.to_string().as_bytes())
                .expect("an answer");
            let usage = answer.usage.expect("a usage");
            assert_eq!(
                (usage.output_tokens, usage.reasoning_tokens),
                (expected, hidden),
                "{reply}"
            );
        }
    }
}

#[test]
fn of_several_messages_remarks_are_left_out_and_one_that_is_cut_is_no_answer() {
    let message = |text: &str, more: Value| {
        let mut message =
            json!({ "type": "message", "content": [{ "type": "output_text", "text": text }] });
        let fields = message.as_object_mut().expect("a table");
        fields.extend(more.as_object().expect("a table").clone());
        message
    };
    let decoded = |output: Value| {
        let reply = json!({ "output": output }).to_string();
        Wire::OpenaiResponses.decode(reply.as_bytes())
    };
    for (output, expected) in [
        (
            json!([
                message("fold", json!({})),
                message("it", json!({ "status": "completed" }))
            ]),
            "fold\n\nit",
        ),
        (
            json!([
                message("I look.", json!({ "phase": "commentary" })),
                message("fold it", json!({ "phase": "final_answer" })),
            ]),
            "fold it",
        ),
    ] {
        assert_eq!(decoded(output).expect("an answer").text, expected);
    }
    let cut = decoded(json!([message("fold", json!({ "status": "incomplete" }))]));
    let cut = cut.expect_err("no answer");
    assert_eq!(cut.fault, Fault::Truncated);
}

#[test]
fn an_error_that_says_nothing_does_not_cost_an_answer() {
    for (wire, reply, _) in ANSWERS {
        for nothing in ["null", "\"\"", "{}", "[]", "false"] {
            let reply: Value = serde_json::from_str(reply).expect("JSON");
            let mut reply = reply;
            reply["error"] = serde_json::from_str(nothing).expect("JSON");
            if *wire == Wire::OpenaiChat {
                reply["choices"][0]["error"] = reply["error"].clone();
            }
            let answer = wire.decode(reply.to_string().as_bytes());
            assert_eq!(answer.expect("an answer").text, "fold it", "{reply}");
        }
        for something in ["true", "\"no\"", "{\"code\":5}", "[0]", "7"] {
            let mut reply: Value = serde_json::from_str(reply).expect("JSON");
            reply["error"] = serde_json::from_str(something).expect("JSON");
            let decoded = wire.decode(reply.to_string().as_bytes());
            assert_eq!(decoded.expect_err("no answer").fault, Fault::ServerFailed);
        }
    }
}

#[test]
fn a_providers_words_are_repeated_on_one_line_and_not_at_any_length() {
    let words = format!("no\u{1b}[2J\nway {}", "x".repeat(100_000));
    for (wire, reply) in [
        (
            Wire::OpenaiChat,
            json!({ "choices": [{ "message": { "refusal": words } }] }),
        ),
        (
            Wire::OpenaiResponses,
            json!({ "output": [{ "type": "message", "content": [{ "type": "refusal", "refusal": words }] }] }),
        ),
        (
            Wire::OpenaiResponses,
            json!({ "status": words, "incomplete_details": { "reason": words } }),
        ),
        (
            Wire::Anthropic,
            json!({ "stop_reason": "refusal", "stop_details": { "explanation": words } }),
        ),
        (
            Wire::Gemini,
            json!({ "promptFeedback": { "blockReason": words } }),
        ),
        (
            Wire::Gemini,
            json!({ "candidates": [{ "finishReason": words, "finishMessage": words }] }),
        ),
    ] {
        let decoded = wire.decode(reply.to_string().as_bytes());
        let why = decoded.expect_err("no answer").why;
        assert!(why.chars().count() < 1000, "{}", why.len());
        assert!(why.contains("no\\u{1b}[2J way x"), "{why}");
        assert!(!why.contains(char::is_control), "{why}");
    }
}

#[test]
fn an_answer_is_not_lost_because_its_bill_cannot_be_read() {
    for (wire, reply, _) in ANSWERS {
        let reply = reply
            .replace(":20", ":-20")
            .replace(":30", ":-30")
            .replace(":15", ":\"fifteen\"");
        let answer = wire.decode(reply.as_bytes()).expect("an answer");
        assert_eq!(
            (answer.text.as_str(), answer.usage),
            ("fold it", None),
            "{reply}"
        );
    }
}

/// A count that is taken for zero would let a cap on the cost be passed.
#[test]
fn a_bill_with_one_unreadable_count_is_unknown_as_a_whole() {
    for (wire, reply, _) in ANSWERS {
        // Every number in these replies is a count.
        let is_digit = |character: char| character.is_ascii_digit();
        let counts = reply.match_indices(':').map(|(at, _)| at + 1);
        let counts = counts.filter(|at| reply[*at..].starts_with(is_digit));
        for at in counts {
            let broken = format!("{}-{}", &reply[..at], &reply[at..]);
            let answer = wire.decode(broken.as_bytes()).expect("an answer");
            assert_eq!(answer.usage, None, "{broken}");
        }
    }
}

#[test]
fn an_empty_refusal_beside_an_answer_refuses_nothing() {
    let reply = r#"{"status":"completed","output":[{"type":"message","content":[{"type":"output_text","text":"fold it","refusal":""}]}]}"#;
    let answer = Wire::OpenaiResponses.decode(reply.as_bytes());
    assert_eq!(answer.expect("an answer").text, "fold it");
}

#[test]
fn every_end_that_is_no_answer_has_a_name() {
    use Fault::*;
    use Wire::*;
    for (wire, reply, fault) in [
        (
            OpenaiChat,
            r#"{"choices":[{"finish_reason":"length","message":{"content":"fol"}}]}"#,
            Truncated,
        ),
        (
            OpenaiChat,
            r#"{"choices":[{"finish_reason":"content_filter","message":{"content":""}}]}"#,
            ContentFiltered,
        ),
        (
            OpenaiChat,
            r#"{"choices":[{"finish_reason":"stop","message":{"content":null,"refusal":"no"}}]}"#,
            Refused,
        ),
        (
            OpenaiChat,
            r#"{"choices":[{"finish_reason":"tool_calls","message":{"content":null,"tool_calls":[{"id":"1"}]}}]}"#,
            InvalidReply,
        ),
        (
            OpenaiChat,
            r#"{"choices":[{"finish_reason":"stop","message":{"content":"","function_call":{"name":"f"}}}]}"#,
            InvalidReply,
        ),
        (
            OpenaiChat,
            r#"{"choices":[{"finish_reason":"error","message":{"content":"x"}}]}"#,
            ServerFailed,
        ),
        (
            OpenaiChat,
            r#"{"choices":[{"finish_reason":"stop","message":{"content":" \n"}}]}"#,
            InvalidReply,
        ),
        (
            OpenaiChat,
            r#"{"choices":[{"finish_reason":"stop","message":{}}]}"#,
            InvalidReply,
        ),
        (
            OpenaiChat,
            r#"{"choices":[{"finish_reason":"repetition","message":{"content":""}}]}"#,
            InvalidReply,
        ),
        (
            OpenaiChat,
            r#"{"choices":[{"finish_reason":"error","message":{"content":""},"error":{"code":429,"message":"slow"}}]}"#,
            RateLimited,
        ),
        (
            OpenaiChat,
            r#"{"choices":[{"error":{"message":"no such upstream"}}]}"#,
            ServerFailed,
        ),
        (OpenaiChat, r#"{"choices":[]}"#, InvalidReply),
        (OpenaiChat, r#"{"choices":null}"#, InvalidReply),
        (
            OpenaiChat,
            r#"{"error":{"message":"slow","code":"rate_limit_exceeded"}}"#,
            RateLimited,
        ),
        (OpenaiChat, r#"{"error":"out of memory"}"#, ServerFailed),
        (
            OpenaiChat,
            r#"{"error":{"message":"x","code":429}}"#,
            RateLimited,
        ),
        (
            OpenaiChat,
            r#"{"error":{"message":"x","code":"402"}}"#,
            QuotaExhausted,
        ),
        (
            OpenaiChat,
            r#"{"error":{"message":"x","code":502}}"#,
            ServerFailed,
        ),
        (
            OpenaiResponses,
            r#"{"status":"incomplete","incomplete_details":{"reason":"max_output_tokens"},"output":[]}"#,
            Truncated,
        ),
        (
            OpenaiResponses,
            r#"{"status":"incomplete","incomplete_details":{"reason":"content_filter"},"output":[]}"#,
            ContentFiltered,
        ),
        (
            OpenaiResponses,
            r#"{"status":"incomplete","incomplete_details":{"reason":"steered"},"output":[]}"#,
            Truncated,
        ),
        (
            OpenaiResponses,
            r#"{"status":"queued","output":[]}"#,
            InvalidReply,
        ),
        (
            OpenaiResponses,
            r#"{"status":"failed","error":{"code":"server_error","message":"x"}}"#,
            ServerFailed,
        ),
        (
            OpenaiResponses,
            r#"{"status":"failed","error":{"code":"rate_limit_exceeded","message":"x"}}"#,
            RateLimited,
        ),
        (
            OpenaiResponses,
            r#"{"status":"failed","error":{"code":"image_content_policy_violation","message":"x"}}"#,
            ContentFiltered,
        ),
        (
            OpenaiResponses,
            r#"{"status":"failed","error":{"code":"invalid_image","message":"x"}}"#,
            BadRequest,
        ),
        (OpenaiResponses, r#"{"status":"failed"}"#, ServerFailed),
        (
            OpenaiResponses,
            r#"{"status":"completed","output":[{"type":"message","content":[{"type":"refusal","refusal":"no"}]}]}"#,
            Refused,
        ),
        (
            OpenaiResponses,
            r#"{"status":"completed","output":[{"type":"function_call","name":"f"}]}"#,
            InvalidReply,
        ),
        (
            OpenaiResponses,
            r#"{"status":"completed","output":[]}"#,
            InvalidReply,
        ),
        (
            Anthropic,
            r#"{"content":[{"type":"text","text":"fol"}],"stop_reason":"max_tokens"}"#,
            Truncated,
        ),
        (
            Anthropic,
            r#"{"content":[],"stop_reason":"model_context_window_exceeded"}"#,
            Truncated,
        ),
        (
            Anthropic,
            r#"{"content":[],"stop_reason":"refusal","stop_details":{"explanation":"no"}}"#,
            Refused,
        ),
        (
            Anthropic,
            r#"{"content":[{"type":"tool_use","id":"1","name":"f","input":{}}],"stop_reason":"tool_use"}"#,
            InvalidReply,
        ),
        (
            Anthropic,
            r#"{"content":[{"type":"tool_use","id":"1","name":"f","input":{}}],"stop_reason":"end_turn"}"#,
            InvalidReply,
        ),
        (
            Anthropic,
            r#"{"content":[{"type":"text","text":""}],"stop_reason":"pause_turn"}"#,
            InvalidReply,
        ),
        (
            Anthropic,
            r#"{"content":[],"stop_reason":"end_turn"}"#,
            InvalidReply,
        ),
        (
            Anthropic,
            r#"{"type":"error","error":{"type":"overloaded_error","message":"busy"}}"#,
            ServerFailed,
        ),
        (
            Gemini,
            r#"{"candidates":[{"content":{"parts":[{"text":"fol"}]},"finishReason":"MAX_TOKENS"}]}"#,
            Truncated,
        ),
        (
            Gemini,
            r#"{"candidates":[{"finishReason":"SAFETY"}]}"#,
            ContentFiltered,
        ),
        (
            Gemini,
            r#"{"candidates":[{"finishReason":"RECITATION","finishMessage":"quoted"}]}"#,
            ContentFiltered,
        ),
        (
            Gemini,
            r#"{"promptFeedback":{"blockReason":"PROHIBITED_CONTENT"}}"#,
            ContentFiltered,
        ),
        (
            Gemini,
            r#"{"candidates":[{"finishReason":"PUP_LIMITED_DISABLED"}]}"#,
            NotAuthorised,
        ),
        (
            Gemini,
            r#"{"candidates":[{"finishReason":"UNEXPECTED_TOOL_CALL"}]}"#,
            InvalidReply,
        ),
        (
            Gemini,
            r#"{"candidates":[{"content":{"parts":[{"functionCall":{"name":"f"}}]},"finishReason":"STOP"}]}"#,
            InvalidReply,
        ),
        (
            Gemini,
            r#"{"candidates":[{"content":{"parts":[{"text":"hm","thought":true}]},"finishReason":"STOP"}]}"#,
            InvalidReply,
        ),
        (Gemini, r#"{"candidates":[]}"#, InvalidReply),
        (Gemini, r#"{}"#, InvalidReply),
    ] {
        let failure = wire.decode(reply.as_bytes()).expect_err("no answer");
        assert_eq!(failure.fault, fault, "{reply}: {failure:?}");
        assert!(!failure.why.is_empty(), "{reply}");
    }
}

#[test]
fn a_paid_text_is_read_unless_it_was_cut_off_or_refused() {
    let decoded = |wire: Wire, reason: Value| {
        let called = json!({ "id": "1" });
        let reply = match wire {
            Wire::OpenaiChat => json!({ "choices": [{ "finish_reason": reason,
                "message": { "content": "fold it", "tool_calls": [called] } }] }),
            Wire::OpenaiResponses => {
                json!({ "status": reason, "output": [{ "type": "function_call" },
                { "type": "message", "content": [{ "type": "output_text", "text": "fold it" }] }] })
            }
            Wire::Anthropic => json!({ "stop_reason": reason,
                "content": [{ "type": "text", "text": "fold it" }, { "type": "tool_use" }] }),
            Wire::Gemini => json!({ "candidates": [{ "finishReason": reason,
                "content": { "parts": [{ "text": "fold it" }, { "functionCall": called }] } }] }),
        };
        wire.decode(reply.to_string().as_bytes())
    };
    for wire in Wire::ALL {
        let words = [
            "stop",
            "STOP",
            "eos",
            "eos_token",
            "end",
            "end_turn",
            "stop_sequence",
            "",
            "tool_calls",
            "function_call",
            "tool_use",
            "unknown",
            "repetition",
        ];
        for reason in words.map(Value::from).into_iter().chain([Value::Null]) {
            let answer = decoded(wire, reason.clone());
            assert_eq!(
                answer.map(|it| it.text),
                Ok("fold it".to_owned()),
                "{wire:?} {reason}"
            );
        }
        for (reason, fault) in [
            ("length", Fault::Truncated),
            ("Max_Tokens", Fault::Truncated),
            ("MAX_TOKENS", Fault::Truncated),
            ("content_filter", Fault::ContentFiltered),
            ("safety", Fault::ContentFiltered),
            ("refusal", Fault::Refused),
            ("error", Fault::ServerFailed),
        ] {
            let failure = decoded(wire, reason.into()).expect_err("no answer");
            assert_eq!(failure.fault, fault, "{wire:?} {reason}");
        }
    }
}

#[test]
fn a_text_that_stands_only_in_a_field_for_reasoning_is_kept_for_the_message() {
    for field in ["reasoning_content", "reasoning"] {
        for (content, end) in [(Value::Null, "stop"), (json!(""), "length")] {
            let message = json!({ "content": content, field: "Pick Point = (1, 2)" });
            let reply = json!({ "choices": [{ "finish_reason": end, "message": message }] });
            let failure = Wire::OpenaiChat.decode(reply.to_string().as_bytes());
            let kept = failure.expect_err("no answer").why;
            let end = format!("; `{field}` holds: `Pick Point = (1, 2)`");
            assert!(kept.ends_with(&end), "{kept}");
        }
    }
}

#[test]
fn an_unknown_end_without_a_text_is_named_and_a_gateways_error_is_repeated() {
    let why = |reply: &str| {
        let decoded = Wire::OpenaiChat.decode(reply.as_bytes());
        decoded.expect_err("no answer").why
    };
    let ended = why(r#"{"choices":[{"finish_reason":"repe\ntition","message":{"content":""}}]}"#);
    assert_eq!(ended, "the answer is empty, and ended with `repe tition`");
    let refused = why(r#"{"choices":[{"error":{"message":"no such upstream"}}]}"#);
    assert_eq!(refused, "no such upstream");
}

#[test]
fn an_empty_answer_of_hidden_reasoning_alone_was_cut_off() {
    for (wire, reply, text) in [
        (
            Wire::OpenaiChat,
            r#"{"choices":[{"finish_reason":"stop","message":{"content":null}}],
            "usage":{"prompt_tokens":1,"completion_tokens":9,"completion_tokens_details":{"reasoning_tokens":9}}}"#,
            "",
        ),
        (
            Wire::OpenaiChat,
            r#"{"choices":[{"finish_reason":"length","message":{"content":"fol","reasoning_content":"hm"}}]}"#,
            "fol",
        ),
        (
            Wire::OpenaiResponses,
            r#"{"status":"incomplete","incomplete_details":{"reason":"max_output_tokens"},"output":[{"type":"reasoning"}]}"#,
            "",
        ),
        (
            Wire::Anthropic,
            r#"{"content":[{"type":"thinking","thinking":"hm"}],"stop_reason":"max_tokens"}"#,
            "",
        ),
        (
            Wire::Gemini,
            r#"{"candidates":[{"content":{"parts":[{"text":"hm","thought":true}]},"finishReason":"MAX_TOKENS"}]}"#,
            "",
        ),
    ] {
        let failure = wire.decode(reply.as_bytes()).expect_err("no answer");
        assert_eq!(failure.fault, Fault::Truncated, "{reply}");
        assert_eq!(failure.cut_text.as_deref(), Some(text), "{reply}");
    }
}

#[test]
fn a_failure_says_what_it_used_all_the_same() {
    let reply = r#"{"choices":[{"finish_reason":"length","message":{"content":""}}],"usage":{"prompt_tokens":3,"completion_tokens":4}}"#;
    let failure = Wire::OpenaiChat
        .decode(reply.as_bytes())
        .expect_err("no answer");
    assert_eq!(failure.usage.map(|usage| usage.output_tokens), Some(4));
}

#[test]
fn what_is_no_json_is_an_invalid_reply_that_is_not_quoted() {
    for bytes in [
        &b""[..],
        b"<html>canary</html>",
        b"{\"choices\": \"canary\"}",
        b"[1]",
        b"\xff\xfe",
        &[b'['; 100_000],
    ] {
        for wire in Wire::ALL {
            if let Err(failure) = wire.decode(bytes) {
                assert_eq!(failure.fault, Fault::InvalidReply, "{wire:?}");
                assert!(!failure.why.contains("canary"), "{}", failure.why);
            }
        }
    }
}

proptest! {
    #[test]
    fn any_bytes_are_an_answer_or_a_failure(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        for wire in Wire::ALL {
            let _ = wire.decode(&bytes);
        }
    }

    #[test]
    fn a_reply_with_any_byte_changed_is_an_answer_or_a_failure(
        which in 0..ANSWERS.len(), at in 0usize..1000, byte in any::<u8>(), end in 0usize..1000,
    ) {
        let (wire, reply, _) = ANSWERS[which];
        let mut bytes = reply.as_bytes().to_vec();
        let at = at % bytes.len();
        bytes[at] = byte;
        let _ = wire.decode(&bytes);
        bytes.truncate(end);
        let _ = wire.decode(&bytes);
    }
}
