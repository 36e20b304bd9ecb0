// Names and references of a robot's file, each changed in many ways: the robot loads, or an InputError names
// the line. Nothing else may happen.

#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/sim_board/description/full_robot.h"

namespace koboshi::sim_board {
namespace {

// Where the names and references of a text are: offset and length.
struct Place {
  std::size_t begin = 0;
  std::size_t size = 0;
};

std::vector<Place> places_in(const std::string& text) {
  static const std::regex kName(
      R"re(\s(?:name|relative_to|expressed_in|attached_to|canonical_link|placement_frame|type|file)=["']([^"']*)["']|<(?:parent|child|uri|frame|koboshi:material|measure_direction)>([^<]*)<)re");
  std::vector<Place> places;
  for (std::sregex_iterator match(text.begin(), text.end(), kName); match != std::sregex_iterator();
       ++match) {
    const std::size_t group = (*match)[1].matched ? 1 : 2;
    places.push_back(
        {static_cast<std::size_t>(match->position(group)), static_cast<std::size_t>(match->length(group))});
  }
  return places;
}

class RobotNames : public testing::Test {
 protected:
  RobotNames() {
    test::write_file(folder_.path / "mesh.stl", "any");
    test::write_file(folder_.path / "library.xml",
                     "<koboshi:servo_types xmlns:koboshi=\"https://koboshi.invalid/sdf\"/>");
    text_ = replaced(replaced(kFullRobot, "FULL_MESH", "mesh.stl"), "FULL_LIBRARY", "library.xml");
    for (const char* unread :
         {"<script><uri>a</uri><name>b</name></script>", "<shader type=\"pixel\"/>"})  // without effect
      if (const std::size_t at = text_.find(unread); at != std::string::npos)
        text_.erase(at, std::string(unread).size());
  }

  // Returns the message of the refusal; empty if the robot loads.
  std::string refusal(const Place& place, const std::string& name) const {
    std::string text = text_;
    text.replace(place.begin, place.size, name);
    try {
      static_cast<void>(load_robot(folder_.path / "robot.sdf", text));
    } catch (const InputError& error) {
      EXPECT_GT(error.line(), 0) << error.what();
      return error.what();
    }
    return {};
  }

  test::TemporaryFolder folder_;
  std::string text_;
};

TEST_F(RobotNames, WithWhiteSpaceOrControlCharactersAreRefused) {
  ASSERT_EQ(refusal({}, ""), "");
  const std::vector<Place> places = places_in(text_);
  ASSERT_GT(places.size(), 20u);
  for (const Place& place : places) {
    const std::string name = text_.substr(place.begin, place.size);
    for (const std::string& bad : {name + " ", " " + name, "\t" + name, name + "\n", name + "\u00A0",
                                   "\uFEFF" + name, name + "&#10;", std::string("a&#1;b"), name + "\u0085",
                                   name + "&#xD800;", name + "\xFF", std::string(), std::string(" ")})
      EXPECT_NE(refusal(place, bad), "") << "'" << name << "' changed to '" << bad << "'";
  }
}

TEST_F(RobotNames, OfAnyOtherKindAreLoadedOrRefused) {
  for (const Place& place : places_in(text_)) {
    const std::string name = text_.substr(place.begin, place.size);
    for (const std::string& other :
         {name + "x", name + "::" + name, "::" + name, "__" + name + "__", std::string("world"),
          std::string("__model__"), std::string("%s%n"), name + " " + name, std::string(5000, 'n'),
          "../" + name, "/" + name, std::string("\U0001F916"), name + "&quot;&lt;&amp;"})
      static_cast<void>(refusal(place, other));
  }
}

}  // namespace
}  // namespace koboshi::sim_board
