#include "simulation/motion_language/compile/decompile.h"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>

#include <fmt/core.h>

#include "firmware/motion/instructions.h"
#include "tests/unit/simulation/motion_language/motion_fixture.h"
#include "tests/unit/simulation/motion_language/random_program.h"

namespace koboshi::simulation {
namespace {

TEST(Decompile, GivesASourceOfTheSameImageForRandomMotions) {
  std::set<motion::Opcode> opcodes;
  int compiled = 0;
  const int count = random_motions(150);
  for (int seed = 0; seed < count; ++seed) {
    const std::string text = RandomProgram(static_cast<std::uint32_t>(seed)).text();
    const Compiled first = compile_text(text);
    if (first.motion.image.empty()) {
      // A random program may need too many variables or let no time pass; any other error is one of the test.
      for (const Diagnostic& diagnostic : first.diagnostics) {
        ASSERT_THAT((std::vector<std::string>{"M036", "M042", "M041", "M040"}),
                    testing::Contains(diagnostic.code))
            << seed << "\n"
            << first.messages() << text;
      }
      continue;
    }
    ++compiled;
    const std::string source = decompile_motion(first.motion.image, koboshi_model(), "image");
    const Compiled second = compile_text(source);
    ASSERT_EQ(second.messages(), "") << seed << "\n" << source;
    ASSERT_EQ(second.motion.image, first.motion.image) << seed << "\n" << text << "\n" << source;
    motion::Motion opened;
    ASSERT_TRUE(motion::Motion::open(first.motion.image, koboshi_model().model, opened).ok());
    for (std::size_t i = 0; i < opened.step_count(); ++i) opcodes.insert(opened.opcode(i));
  }
  EXPECT_GT(compiled, count / 3);
  EXPECT_EQ(opcodes.size(), static_cast<std::size_t>(motion::kLastOpcode) + 1) << "every opcode was there";
}

TEST(Decompile, RefusesWhatIsNoImage) {
  const std::vector<std::byte> nothing(20);
  EXPECT_THROW(static_cast<void>(decompile_motion(nothing, koboshi_model(), "x.kmot")), InputError);
}

TEST(Decompile, SaysOfOtherFilesThatTheyAreNoImage) {
  for (const std::string_view text :
       {"", "hello", "KMOT", "version: 2\nrobot: koboshi\nname: a\nsteps: [end]\n"}) {
    try {
      static_cast<void>(decompile_motion(std::as_bytes(std::span(text)), koboshi_model(), "x"));
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_STREQ(error.what(),
                   "x: found something that is no motion image, expected the image of a motion for koboshi");
    }
  }
}

TEST(Decompile, RefusesBytesBehindTheImage) {
  std::vector<std::byte> image =
      compile_text("version: 2\nrobot: koboshi\nname: a\nsteps: [{wait_s: 1}]\n").motion.image;
  const std::string size = std::to_string(image.size());
  image.emplace_back();
  try {
    static_cast<void>(decompile_motion(image, koboshi_model(), "x.kmot"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "x.kmot: found 1 byte behind the end of the image, expected the image alone, of " + size + " bytes");
  }
}

// --- Robustness: a short form of the fuzzing under the sanitizers; KOBOSHI_MUTATIONS=100000 runs the long
// one.

int mutations() {
  const char* text = std::getenv("KOBOSHI_MUTATIONS");
  return text == nullptr ? 400 : std::atoi(text);
}

TEST(MotionSources, MutatedOnesAreAcceptedOrRefused) {
  static const std::vector<std::string> kPieces{"&a ",
                                                "*a",
                                                "- ",
                                                "{",
                                                "}",
                                                "[",
                                                "]",
                                                ": ",
                                                "\n",
                                                "  ",
                                                "99999999999999",
                                                "1e999",
                                                "nan",
                                                "-",
                                                "0",
                                                "from",
                                                "mirror",
                                                "others",
                                                "p0",
                                                "left_knee",
                                                "support: left",
                                                "com: {z_mm: 1}",
                                                "\"",
                                                "'",
                                                "#",
                                                "until",
                                                "while",
                                                "if",
                                                "steps",
                                                "\t",
                                                "\xff",
                                                "(((((((",
                                                "not not not",
                                                "+ - + -",
                                                "<<",
                                                "!!map ",
                                                "trunk: {z_mm: 170, pitch_deg: 30}"};
  std::mt19937 random(7);
  int accepted = 0;
  const int count = mutations();
  std::string text;
  for (int i = 0; i < count; ++i) {
    if (i % 10 == 0) text = RandomProgram(static_cast<std::uint32_t>(i)).text();
    std::string mutated = text;
    for (int change = 0; change < 1 + static_cast<int>(random() % 3); ++change) {
      const std::size_t at = random() % mutated.size();
      const std::size_t length = std::min<std::size_t>(random() % 12, mutated.size() - at);
      switch (random() % 4) {
        case 0:
          mutated.erase(at, length);
          break;
        case 1:
          mutated.insert(at, kPieces[random() % kPieces.size()]);
          break;
        case 2:
          mutated.insert(at, mutated.substr(random() % mutated.size(), length * 5));
          break;
        default:
          mutated[at] = static_cast<char>(random());
      }
    }
    const Compiled compiled = compile_text(mutated);
    EXPECT_NE(
        compiled.motion.image.empty(),
        std::none_of(compiled.diagnostics.begin(), compiled.diagnostics.end(),
                     [](const Diagnostic& diagnostic) { return diagnostic.severity == Severity::kError; }))
        << mutated;
    accepted += compiled.motion.image.empty() ? 0 : 1;
  }
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, count);
}

TEST(MotionSources, OfAbsurdShapeAreRefused) {
  const auto nested = [](const std::string& open, const std::string& close) {
    std::string text;
    for (int i = 0; i < 20'000; ++i) text += open;
    for (int i = 0; i < 20'000; ++i) text += close;
    return text;
  };
  EXPECT_NE(compile_text(nested("[", "]")).codes(), "");
  EXPECT_NE(compile_text(version_2("steps: " + nested("[{if: a, then: ", "}]") + "\n")).codes(), "");
  EXPECT_NE(compile_text(version_2("variables: {x: 0}\nsteps: [{set: {x: \"" + nested("(", ")") + "\"}}]\n"))
                .codes(),
            "");
  EXPECT_NE(compile_text(version_2("variables: {x: 0}\nsteps: [{set: {x: \"" + nested("-", "1") + "\"}}]\n"))
                .codes(),
            "");
  EXPECT_NE(compile_text("a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n").codes(), "");
  std::string poses = "version: 2\nrobot: koboshi\nname: a\nposes:\n  p0: {knee: 1}\n";
  for (int i = 1; i < 500; ++i) poses += fmt::format("  p{}: {{from: p{}}}\n", i, i - 1);
  EXPECT_EQ(compile_text(poses + "steps: [{pose: p499, time_s: 1}]\n").codes(), "");
  EXPECT_NE(compile_text(std::string((1u << 20) + 1, ' ')).codes(), "");
}

}  // namespace
}  // namespace koboshi::simulation
