//! Foreign text on a terminal.

use super::*;

#[test]
fn foreign_words_are_visible_and_a_terminal_does_not_take_their_colours() {
    for is_terminal in [false, true] {
        let mut io = Io::in_memory();
        let streams = Arc::get_mut(&mut io.streams).expect("nobody else has the streams");
        streams.terminals = [false, is_terminal, is_terminal];
        io.talk("error: \x1b[2Jbad \x1b[31m key");
        let seen = "error: \\u{1b}[2Jbad \\u{1b}[31m key\n";
        assert_eq!(io.captured().stderr, seen);
        io.data("bad \x1b[31m key");
        // A program gets the bytes as they are.
        let seen = if is_terminal {
            "bad \\u{1b}[31m key\n"
        } else {
            "bad \x1b[31m key\n"
        };
        assert_eq!(io.captured().stdout, seen);
    }
}
