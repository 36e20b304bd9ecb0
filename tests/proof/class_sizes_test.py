"""Counts the functions and data members of every class, which stays small enough to be read at once.

A class that has a reason to be larger states it beside its name: `// Large: REASON`. Structs without functions are tables.
"""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("base", "mechanics", "hal", "firmware", "sim_board", "simulation", "bus", "view", "tools", "lab", "studio", "cli")
MOST_FUNCTIONS = 45
MOST_MEMBERS = 25

CLASS = re.compile(r"\b(?:class|struct)\s+(?:alignas\([^)]*\)\s*)?([\w:]+)\s*(?:final\s*)?(?::[^;{]*)?\{")
IGNORED = re.compile(r"^(?:using|typedef|friend|static_assert|enum|class|struct|union|Q_OBJECT|template\s*<[^;]*>\s*(?:class|struct))\b")
LABEL = re.compile(r"^(?:(?:public|protected|private)(?:\s+Q_SLOTS)?|Q_SIGNALS|signals)\s*:")
LARGE = re.compile(r"//.*\bLarge: \S")


def without_comments(text):
    """The text with the contents of comments and literals as blanks, so that places stay."""
    pattern = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.*?)\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', re.DOTALL)
    return pattern.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)


def closing(text, start):
    """The place behind the brace that closes the one at `start`."""
    depth = 0
    for place in range(start, len(text)):
        depth += {"{": 1, "}": -1}.get(text[place], 0)
        if depth == 0:
            return place + 1
    raise ValueError("braces do not match")


def declarations(body):
    """The declarations of a class, without the bodies of functions, classes and initialisers."""
    found, current, place = [], "", 0
    while place < len(body):
        character = body[place]
        if character == "{":
            place = closing(body, place)
            # The body of a function ends its declaration; that of a class or an initialiser is followed by more.
            if "(" in current.split("=")[0] and not re.match(r"\s*[,{]", body[place:]) or "operator" in current:
                found.append(current.strip())
                current = ""
            else:
                current += " {} "
            continue
        if character == ";":
            found.append(current.strip())
            current = ""
        elif character == ":" and LABEL.match(current.strip() + ":"):
            current = ""
        else:
            current += character
        place += 1
    return [line for line in found if line]


def sizes(text):
    """Yields name, line, number of functions and number of data members of each class in a header."""
    plain = without_comments(text)
    for match in CLASS.finditer(plain):
        if re.search(r"\benum\s*$", plain[:match.start()]) or plain[:match.start()].rstrip().endswith("<"):
            continue
        body = plain[match.end():closing(plain, match.end() - 1) - 1]
        functions = members = 0
        for line in declarations(body):
            line = re.sub(r"\[\[\w+\]\]|^\s*template\s*<[^()]*?>\s*", "", line).strip()
            if not line or IGNORED.match(line) or line.endswith(("= delete", "= default")):
                continue
            for _ in range(3):  # nested arguments of templates
                line = re.sub(r"<[^<>]*>", "", line)
            head = line.split("=")[0].split("{}")[0]
            if "(" in head or "operator" in head:
                functions += 1
            elif not re.match(r"^(?:inline\s+)?static\s+constexpr\b|^constexpr\b", line):
                members += 1 + line.count(",")
        yield match.group(1), plain.count("\n", 0, match.start()) + 1, functions, members


def has_reason(text, line):
    """Whether the class whose name is in this line has a reason for its size, behind its opening brace."""
    for following in text.split("\n")[line - 1:]:
        if "{" in following:
            return bool(LARGE.search(following))
    return False


class Classes(unittest.TestCase):
    maxDiff = None

    def test_are_small_or_say_why_not(self):
        large = []
        for folder in FOLDERS:
            for path in sorted((ROOT / folder).rglob("*.h")):
                text = path.read_text()
                for name, line, functions, members in sizes(text):
                    if functions <= MOST_FUNCTIONS and (members <= MOST_MEMBERS or functions == 0):
                        continue
                    if not has_reason(text, line):
                        large.append(f"{path.relative_to(ROOT)}:{line}: {name} has {functions} functions and {members} members")
        self.assertEqual(large, [])


class Counting(unittest.TestCase):
    def sizes_of(self, text):
        return [(name, functions, members) for name, _, functions, members in sizes(text)]

    def test_counts_functions_and_members(self):
        self.assertEqual(self.sizes_of("""
            // A class of three functions.
            class Sample final : public Base<int> {
             public:
              explicit Sample(int size = 3) : size_(size) { fill(); }
              Sample(const Sample&) = delete;
              ~Sample();
              std::function<void(int)> get() const;
              using Name = std::string;
              static constexpr int kMost = 4;  // int not_counted;
              enum class Kind { kOne, kTwo };
             private:
              struct Inner { int a = 0; int b{1}; };
              int size_ = 0, count_ = 0;
              std::vector<std::function<void(int)>> calls_;
              std::array<int, 3> values_{1, 2, 3};
            };"""), [("Sample", 3, 4), ("Inner", 0, 2)])

    def test_counts_operators_and_templates(self):
        self.assertEqual(self.sizes_of("""
            template <typename T>
            struct Other {
              bool operator==(const Other&) const = default;
              Other& operator+=(const Other& other) { return *this; }
              template <typename U> void take(U&& value) { hold(value); }
              [[nodiscard]] T value() const { return value_; }
              T value_{};
            };"""), [("Other", 3, 1)])

    def test_accepts_a_reason(self):
        text = "class Keys : public One,\n             public Two {  // Large: a table\n  int a;  // Large: no\n};\n"
        self.assertTrue(has_reason(text, 1))
        self.assertFalse(has_reason(text.replace("Large: a table", "a large table"), 1))


if __name__ == "__main__":
    unittest.main()
