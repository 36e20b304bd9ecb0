#include "base/yaml/yaml_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "tests/unit/base/scratch_file.h"

namespace koboshi {
namespace {

using testing::ElementsAre;

// Returns the complaint of reading `text`, with the file's name as FILE; "nothing" if there is none.
std::string complaint(const std::string& text, const std::function<void(const YamlMap&)>& read,
                      const std::vector<Override>& overrides = {}) {
  const ScratchFile scratch("yaml", text);
  try {
    const YamlFile file(scratch.path(), overrides);
    read(file.root());
    file.finish();
  } catch (const InputError& error) {
    std::string message = error.what();
    if (message.starts_with(scratch.path().string()))
      message.replace(0, scratch.path().string().size(), "FILE");
    return message;
  }
  return "nothing";
}

void read_nothing(const YamlMap&) {}

void read_number(const YamlMap& root) { root.number("x", {.min = 0.01, .max = 3600}); }

TEST(YamlReader, ReadsEveryType) {
  const ScratchFile scratch(
      "yaml",
      "version: 1\nduration_s: 2.5\nseed: -7\nnoise: true\nmotion: squat\nstepper: quick\n"
      "ground: {mu: .8}\npushes:\n  - at_s: 1\n  - at_s: 2\nforce_N: [1, -2e1, +3]\n");
  const YamlFile file(scratch.path());
  const YamlMap root = file.root();
  root.require_version(1);
  EXPECT_EQ(root.number("duration_s", {.min = 0}), 2.5);
  EXPECT_EQ(root.integer("seed"), -7);
  EXPECT_TRUE(root.boolean("noise"));
  EXPECT_EQ(root.text("motion"), "squat");
  EXPECT_EQ(root.one_of("stepper", {"world", "quick"}), "quick");
  EXPECT_EQ(root.child("ground").number("mu"), 0.8);
  std::vector<double> times;
  for (const YamlValue& push : root.list("pushes")) times.push_back(push.map().number("at_s"));
  EXPECT_THAT(times, ElementsAre(1, 2));
  EXPECT_THAT(root.numbers("force_N", 3), ElementsAre(1, -20, 3));
  EXPECT_EQ(root.line_of("pushes"), 8);
  file.finish();
}

TEST(YamlReader, ConvertsToTheUnitOfTheKey) {
  const ScratchFile scratch("yaml", "duration_s: 500ms\nposition_m: [10 cm, 1]\nturn_rad_per_s: 90 deg/s\n");
  const std::vector<Override> overrides{{"pause_s", "2 min"}};
  const YamlFile file(scratch.path(), overrides);
  EXPECT_EQ(file.root().number("duration_s"), 0.5);
  EXPECT_THAT(file.root().numbers("position_m", 2), ElementsAre(0.1, 1.0));
  EXPECT_NEAR(file.root().number("turn_rad_per_s"), 1.5708, 1e-4);
  EXPECT_EQ(file.root().number("pause_s"), 120.0);
  EXPECT_EQ("FILE:1: found x_s = 5 kg, expected a number with the unit s, ms, us, min or h",
            complaint("x_s: 5 kg\n", [](const YamlMap& root) { root.number("x_s"); }));
  EXPECT_EQ("FILE:1: found x = 5s, expected a number from 0.01 to 3600", complaint("x: 5s\n", read_number));
  EXPECT_EQ("FILE:1: found x_s = 5000000ms, expected a number of 3600 or less",
            complaint("x_s: 5000000ms\n", [](const YamlMap& root) { root.number("x_s", {.max = 3600}); }));
  EXPECT_EQ("FILE:1: found x_s = \"5s\", expected a number",
            complaint("x_s: \"5s\"\n", [](const YamlMap& root) { root.number("x_s"); }));
}

TEST(YamlReader, ReadsLinesOfOtherSystemsOrRefusesThem) {
  const auto read = [](const YamlMap& root) {
    EXPECT_EQ(root.number("x"), 1.0);
    EXPECT_EQ(root.number("y"), 2.0);
  };
  EXPECT_EQ("nothing", complaint("\xEF\xBB\xBFx: 1 # one\r\ny: 2\r\n", read));
  EXPECT_EQ("FILE:1: found a line that ends with CR alone, expected LF or CR LF",
            complaint("x: 1 # one\ry: 2\r", read));
  EXPECT_EQ("FILE:2: found a line that ends with CR alone, expected LF or CR LF",
            complaint("x: 1\r\ny: 2\r", read));
}

TEST(YamlReader, UsesTheFallbackOnlyForAMissingKey) {
  EXPECT_EQ("nothing", complaint("a: 1\n", [](const YamlMap& root) {
              root.integer("a");
              EXPECT_EQ(root.number("x", {}, 4.0), 4.0);
              EXPECT_EQ(root.integer("i", {}, 5), 5);
              EXPECT_FALSE(root.boolean("b", false));
              EXPECT_EQ(root.text("t", "none"), "none");
              EXPECT_EQ(root.one_of("o", {"p", "q"}, "q"), "q");
              EXPECT_FALSE(root.optional_child("c").has_value());
            }));
  EXPECT_EQ("FILE:1: found x = oops, expected a number",
            complaint("x: oops\n", [](const YamlMap& root) { root.number("x", {}, 4.0); }));
}

TEST(YamlReader, NamesFileAndReasonWhenItCannotBeRead) {
  const auto message = [](const std::filesystem::path& path) -> std::string {
    try {
      YamlFile file(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_EQ(message("no/such.yaml"), "no/such.yaml: found no such file, expected a YAML file");
  EXPECT_EQ(message("/"), "/: found a folder, expected a YAML file");
  EXPECT_EQ(message("/dev/zero"), "/dev/zero: found more than 16 MiB, expected a YAML file");
}

TEST(YamlReader, RejectsAnythingButAMap) {
  EXPECT_EQ(complaint("", read_nothing), "FILE:1: found an empty file, expected a map of keys and values");
  EXPECT_EQ(complaint("\n- 1\n", read_nothing),
            "FILE:2: found a document that is no map, expected a map of keys and values");
  EXPECT_EQ(complaint("a: 1\n---\nb: 2\n", read_nothing),
            "FILE:3: found a second document, expected one document");
}

TEST(YamlReader, RejectsMalformedTextWithItsLine) {
  EXPECT_THAT(complaint("a: 1\nb: [1, 2\n", read_nothing),
              testing::MatchesRegex("FILE:[23]: found .*, expected well-formed YAML"));
  EXPECT_THAT(complaint("a: 1\n  b: 2\n", read_nothing),
              testing::MatchesRegex("FILE:2: found .*, expected well-formed YAML"));
  EXPECT_THAT(complaint(std::string(100000, '['), read_nothing),
              testing::MatchesRegex("FILE:1: found .*, expected .*"));
}

TEST(YamlReader, TellsTheLimitOfNesting) {
  const std::string limit =
      ": found maps and lists nested deeper than 100 levels, expected at most 100 levels";
  const auto lists = [](std::size_t depth) {
    return "a: 1\nb: " + std::string(depth, '[') + std::string(depth, ']') + "\n";
  };
  EXPECT_EQ(complaint(lists(99), [](const YamlMap& root) { root.entries(); }), "nothing");
  EXPECT_EQ(complaint(lists(100), read_nothing), "FILE:2" + limit);
  EXPECT_EQ(complaint(lists(600), read_nothing), "FILE:2" + limit);
  std::string maps = "a: 1\n";
  for (std::size_t i = 0; i < 200; ++i) maps += std::string(i, ' ') + "b:\n";
  EXPECT_EQ(complaint(maps, read_nothing), "FILE:102" + limit);
}

TEST(YamlReader, RejectsNamesWithWhiteSpaceAtTheirEnds) {
  const auto read_text = [](const YamlMap& root) { root.text("x"); };
  EXPECT_EQ(complaint("x: 'knee '", read_text),
            "FILE:1: found x = \"knee \", expected a text without white space at its end");
  EXPECT_EQ(complaint("x: |\n  knee\n", read_text),
            "FILE:1: found x = \"knee \", expected a text without a control character");
  EXPECT_EQ(complaint("' x': 1", read_nothing),
            "FILE:1: found the key \" x\", expected a name without white space at its beginning");
}

TEST(YamlReader, RejectsDuplicateKeys) {
  EXPECT_EQ(complaint("a: 1\nground:\n  mu: 1\n  mu: 2\n", read_nothing),
            "FILE:4: found a second ground.mu (the first is in line 3), expected each key once");
}

TEST(YamlReader, RejectsAliasesTagsAndOddKeys) {
  EXPECT_EQ(complaint("a: &x 1\nb: *x\n", read_nothing), "FILE:2: found an alias, expected the value itself");
  EXPECT_EQ(complaint("a: !!int 1\n", read_nothing),
            "FILE:1: found the tag tag:yaml.org,2002:int, expected a value without a tag");
  EXPECT_EQ(complaint("? [a]\n: 1\n", read_nothing), "FILE:1: found a map or list as a key, expected a name");
  EXPECT_EQ(complaint("~: 1\n", read_nothing), "FILE:1: found an empty key, expected a name");
}

TEST(YamlReader, RejectsUnknownKeysAndListsKnownOnes) {
  const auto read = [](const YamlMap& root) {
    root.number("duration_s");
    if (const auto ground = root.optional_child("ground")) ground->number("mu", {}, 1.0);
  };
  EXPECT_EQ(
      complaint("duration_s: 1\ndurations: 2\n", read),
      "FILE:2: found the unknown key durations, expected duration_s or ground; the nearest is duration_s");
  EXPECT_EQ(complaint("duration_s: 1\nground:\n  mux: 2\n", read),
            "FILE:3: found the unknown key ground.mux, expected mu");
}

TEST(YamlReader, RejectsMissingKeysAtTheirMap) {
  EXPECT_EQ(complaint("y: 1\n", read_number), "FILE:1: found no key x, expected a number from 0.01 to 3600");
  EXPECT_EQ(complaint("a: 1\n\nground: {}\n", [](const YamlMap& root) { root.child("ground").text("mesh"); }),
            "FILE:3: found no key ground.mesh, expected a text");
}

TEST(YamlReader, RejectsNumbersOutOfRangeOrNotFinite) {
  EXPECT_EQ(complaint("\nx: -3\n", read_number), "FILE:2: found x = -3, expected a number from 0.01 to 3600");
  for (const char* text :
       {".nan", "nan", ".inf", "-.inf", "inf", "1e999", "0x10", "1 s", "3601", "0.0099", "1,5"}) {
    EXPECT_EQ(complaint("x: " + std::string(text) + "\n", read_number),
              "FILE:1: found x = " + std::string(text) + ", expected a number from 0.01 to 3600");
  }
}

TEST(YamlReader, RejectsWrongTypes) {
  EXPECT_EQ(complaint("x: \"7\"\n", read_number),
            "FILE:1: found x = \"7\", expected a number from 0.01 to 3600");
  EXPECT_EQ(complaint("x:\n", read_number),
            "FILE:1: found x without a value, expected a number from 0.01 to 3600");
  EXPECT_EQ(complaint("x: {y: 1}\n", read_number),
            "FILE:1: found x, a map, expected a number from 0.01 to 3600");
  EXPECT_EQ(complaint("x: 1.5\n", [](const YamlMap& root) { root.integer("x", {.min = 1}); }),
            "FILE:1: found x = 1.5, expected an integer of 1 or more");
  EXPECT_EQ(complaint("x: 99999999999999999999\n", [](const YamlMap& root) { root.integer("x"); }),
            "FILE:1: found x = 99999999999999999999, expected an integer");
  for (const std::string bad : {"0x", "0x1g", "0x-1", "0x100000000", "x1"}) {
    EXPECT_EQ(complaint("x: " + bad + "\n", [](const YamlMap& root) { root.integer("x"); }),
              "FILE:1: found x = " + bad + ", expected an integer");
  }
  EXPECT_EQ(complaint("x: 0x7fF\n", [](const YamlMap& root) { EXPECT_EQ(root.integer("x"), 0x7FF); }),
            "nothing");
  EXPECT_EQ(complaint("x: yes\n", [](const YamlMap& root) { root.boolean("x"); }),
            "FILE:1: found x = yes, expected true or false");
  EXPECT_EQ(complaint("x: [a]\n", [](const YamlMap& root) { root.text("x"); }),
            "FILE:1: found x, a list, expected a text");
  EXPECT_EQ(complaint("x: slow\n",
                      [](const YamlMap& root) {
                        root.one_of("x", {"world", "quick"});
                      }),
            "FILE:1: found x = slow, expected world or quick");
  EXPECT_EQ(complaint("x: [1, 2]\n", [](const YamlMap& root) { root.numbers("x", 3); }),
            "FILE:1: found x, a list, expected a list of 3 numbers");
  EXPECT_EQ(complaint("x:\n - 1\n - b\n", [](const YamlMap& root) { root.numbers("x", 2); }),
            "FILE:3: found x[1] = b, expected a number");
}

TEST(YamlReader, ChecksTheVersion) {
  const auto read = [](const YamlMap& root) { root.require_version(1); };
  EXPECT_EQ(complaint("version: 1\n", read), "nothing");
  EXPECT_EQ(complaint("version: 2\n", read), "FILE:1: found version = 2, expected version 1");
  EXPECT_EQ(complaint("name: a\n", read), "FILE:1: found no key version, expected version 1");
}

TEST(YamlReader, ReportsErrorsOfCallersAtTheirLine) {
  EXPECT_EQ(complaint("a: 1\nmotion: jump\n",
                      [](const YamlMap& root) {
                        throw root.error_at("motion", "motion = jump", "a motion of this robot");
                      }),
            "FILE:2: found motion = jump, expected a motion of this robot");
}

TEST(YamlReader, KeepsMessagesOnOneLine) {
  EXPECT_EQ(complaint("x: |\n  two\n  lines\n", read_number),
            "FILE:1: found x = \"two lines \", expected a number from 0.01 to 3600");
  EXPECT_LT(complaint("x: " + std::string(100000, 'a') + "\n", read_number).size(), 200u);
}

TEST(YamlOverrides, ReplaceAndAddValues) {
  EXPECT_EQ("nothing",
            complaint("x: 1\npushes:\n  - {at_s: 1}\n",
                      [](const YamlMap& root) {
                        EXPECT_EQ(root.number("x"), 5);
                        EXPECT_EQ(root.child("ground").number("mu"), 0.5);
                        EXPECT_EQ(root.list("pushes")[0].map().number("at_s"), 9);
                        EXPECT_THAT(root.numbers("force", 2), ElementsAre(1, 2));
                      },
                      {parse_override("x=2"), parse_override("x=5"), parse_override("ground.mu=0.5"),
                       parse_override("pushes.0.at_s=9"), parse_override("force=[1, 2]")}));
}

TEST(YamlOverrides, NameTheOptionInTheirErrors) {
  const auto read = [](const YamlMap& root) { root.child("ground").number("mu", {.min = 0}, 1.0); };
  const auto with = [&](const char* argument) {
    return complaint("ground: {mu: 1}\n", read, {parse_override(argument)});
  };
  EXPECT_EQ(with("ground.mux=1"), "--set: found the unknown key ground.mux, expected mu");
  EXPECT_EQ(with("grund.mu=1"), "--set: found the unknown key grund, expected ground");
  EXPECT_EQ(with("ground.mu=-1"), "--set: found ground.mu = -1, expected a number of 0 or more");
  EXPECT_EQ(with("ground.mu.x=1"), "--set: found ground.mu.x, expected ground.mu to be a map");
  EXPECT_EQ(with("ground={mu: 1, b: 2}"), "--set: found the unknown key ground.b, expected mu");
  EXPECT_THAT(with("ground.mu=[1"), testing::MatchesRegex("--set: found .*, expected .*"));
  EXPECT_EQ(complaint("ground: {mu: 1}\n", read, {{"ground.mu", "abc", "--mu"}}),
            "--mu: found ground.mu = abc, expected a number of 0 or more");
  EXPECT_EQ(complaint("a: [1]\n", read_nothing, {{"a.1", "2"}}),
            "--set: found a.1, expected an item of a, which has 1");
  for (const char* argument : {"x", "=1", "x="}) EXPECT_THROW(parse_override(argument), InputError);
}

}  // namespace
}  // namespace koboshi
