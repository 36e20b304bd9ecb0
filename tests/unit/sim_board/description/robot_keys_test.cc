#include "sim_board/description/robot_keys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "base/xml/xml_reader.h"
#include "sim_board/description/load.h"
#include "sim_board/description/schema/sdf_schema.h"
#include "tests/unit/base/scratch_file.h"
#include "tests/unit/sim_board/description/full_robot.h"
#include "tests/unit/sim_board/description/robot_text.h"
#include "tests/unit/sim_board/description/small_robot.h"

namespace koboshi::sim_board {
namespace {

using testing::HasSubstr;
using tinyxml2::XMLElement;

// kFullRobot in SDF 1.6, with the older keys.
std::string older_full_robot() {
  std::string text = replaced(kFullRobot, "version=\"1.9\"", "version=\"1.6\"");
  text = replaced(text, " expressed_in=\"base\"", "");
  text = replaced(text, "</axis>", "<use_parent_model_frame>true</use_parent_model_frame></axis>");
  while (text.find(" relative_to=") != std::string::npos) text = replaced(text, " relative_to=", " frame=");
  return text;
}

// Whether later versions of SDF have another key instead.
bool is_older(const RobotKey& key) { return key.note.source == "SDF 1.6"; }

// kFullRobot with edits of keys that are given by their path in the table.
class KeyedRobot {
 public:
  // `is_older`: the robot with the older keys.
  explicit KeyedRobot(bool is_older = false) {
    static const std::array kOriginals{original(kFullRobot), original(older_full_robot())};
    document_.Parse(kOriginals[is_older ? 1 : 0].c_str());
  }

  // The first element of the path, which may be in any of several parents; for an attribute, its element.
  XMLElement* find(const RobotKey& key) {
    const std::string path = key.path.substr(0, key.path.find('@'));
    XMLElement* model = document_.RootElement()->FirstChildElement("model");
    return path.empty() ? model : find_below(*model, path, key);
  }

  void set(const RobotKey& key, const std::string& value) {
    XMLElement* element = find(key);
    if (key.is_attribute) {
      element->SetAttribute(key.name.c_str(), value.c_str());
    } else {
      element->SetText(value.c_str());
    }
  }

  void remove(const RobotKey& key) {
    XMLElement* element = find(key);
    if (key.is_attribute) {
      element->DeleteAttribute(key.name.c_str());
    } else {
      element->Parent()->DeleteChild(element);
    }
  }

  // The value of another key that stands beside this one.
  std::string sibling(const RobotKey& key, const std::string& name) {
    return find(key)->Parent()->ToElement()->FirstChildElement(name.c_str())->GetText();
  }

  std::string xml() const {
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

  std::string text() const {
    const ScratchFile file("sdf", xml());
    return robot_text(load_robot(file.path()));
  }

  // The table's finding in it.
  std::string complaint() const {
    try {
      XmlFile file("FILE", xml(), sdf_rule());
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  }

 private:
  XMLElement* find_below(XMLElement& parent, const std::string& path, const RobotKey& key) {
    const std::size_t end = path.find('/');
    for (XMLElement* child = parent.FirstChildElement(path.substr(0, end).c_str()); child != nullptr;
         child = child->NextSiblingElement(path.substr(0, end).c_str())) {
      if (end != std::string::npos) {
        if (XMLElement* found = find_below(*child, path.substr(end + 1), key)) return found;
      } else if (!key.is_attribute || child->Attribute(key.name.c_str()) != nullptr) {
        return child;
      }
    }
    return nullptr;
  }

  // A robot with its other files, which all robots of the program share.
  static std::string original(const std::string& robot) {
    static const ScratchFile mesh("stl", "");
    static const ScratchFile library("xml",
                                     "<koboshi:servo_types xmlns:koboshi=\"https://koboshi.invalid/sdf\"/>");
    return replaced(replaced(robot, "FULL_MESH", mesh.path().string()), "FULL_LIBRARY",
                    library.path().string());
  }

  tinyxml2::XMLDocument document_;
};

TEST(RobotKeys, SayWhatEachKeyIs) {
  std::set<std::string> paths;
  for (const RobotKey& key : robot_keys()) {
    EXPECT_TRUE(paths.insert(key.path).second) << key.path;
    EXPECT_FALSE(key.note.meaning.empty()) << key.path;
    EXPECT_FALSE(key.note.meaning.ends_with('.')) << key.path;
    EXPECT_FALSE(key.note.source.empty()) << key.path;
    const bool is_number = key.content == XmlContent::kNumbers || key.content == XmlContent::kInteger;
    EXPECT_EQ(is_number, !key.note.unit.empty()) << key.path;
    EXPECT_EQ(key.has_value(), !describe_values(key).empty()) << key.path;
    EXPECT_TRUE(key.count != XmlCount::kRequired || key.note.fallback.empty()) << key.path;
    EXPECT_EQ(find_robot_key(key.path), &key);
  }
  EXPECT_GT(paths.size(), 150u);
  EXPECT_EQ(find_robot_key("link/inertial/weight"), nullptr);
  const RobotKey* mass = find_robot_key("link/inertial/mass");
  ASSERT_NE(mass, nullptr);
  EXPECT_EQ(mass->note.unit, "kg");
  EXPECT_EQ(describe_values(*mass), "a number from 1e-06 to 1000");
  EXPECT_EQ(describe_values(*find_robot_key("joint/koboshi:drive@sign")), "1 or -1");
}

TEST(RobotKeys, AreAllInTheFullRobot) {
  for (const RobotKey& key : robot_keys())
    EXPECT_NE(KeyedRobot(is_older(key)).find(key), nullptr) << key.path;
  for (const bool is_older : {false, true})
    EXPECT_THAT(KeyedRobot(is_older).text(), HasSubstr("robot | full"));
}

// A key's default, for its element in `robot`.
std::string default_of(KeyedRobot& robot, const RobotKey& key) {
  return key.note.fallback == "mu" ? robot.sibling(key, "mu") : key.note.fallback;
}

// The table says what the reader does without a key; the reader's own defaults are those of description.h.
TEST(RobotKeys, HaveTheDefaultsOfTheReader) {
  for (const bool is_older_robot : {false, true}) {
    KeyedRobot without(is_older_robot);
    KeyedRobot with_defaults(is_older_robot);
    int defaults = 0;
    for (const RobotKey& key : robot_keys()) {
      if (key.note.fallback.empty() || (is_older(key) && !is_older_robot)) continue;
      with_defaults.set(key, default_of(with_defaults, key));
      if (key.name == "pose")
        for (const char* reference : {"relative_to", "frame"})
          with_defaults.find(key)->DeleteAttribute(reference);
      without.remove(key);
      ++defaults;
    }
    EXPECT_GT(defaults, 50);
    EXPECT_EQ(without.text(), with_defaults.text());
  }
}

TEST(RobotKeys, AreOptionalAsTheTableSaysAndHaveAnEffect) {
  for (const RobotKey& key : robot_keys()) {
    KeyedRobot without(is_older(key));
    const std::string full = without.text();
    without.remove(key);
    if (key.count == XmlCount::kRequired) {
      EXPECT_THAT(without.complaint(),
                  HasSubstr(key.is_attribute ? "without " + key.name : "without <" + key.name + ">"));
    } else if (!key.note.fallback.empty()) {
      EXPECT_NE(without.text(), full) << key.path;
    }
  }
}

// As many numbers as the key has, each of them `value`.
std::string repeated_value(const RobotKey& key, double value) {
  std::string text;
  for (std::size_t i = 0; i < key.numbers; ++i) text += (i > 0 ? " " : "") + number_text(value);
  return text;
}

TEST(RobotKeys, HaveTheRangesOfTheReader) {
  for (const RobotKey& key : robot_keys()) {
    if (!key.has_value()) continue;
    std::vector<std::string> bad{""};
    if (key.content != XmlContent::kText || !key.choices.empty()) bad.push_back("nonsense");
    if (key.range.min > NumberRange().min)
      bad.push_back(repeated_value(key, key.range.min - 0.1 * std::abs(key.range.min) - 1e-13));
    if (key.range.max < NumberRange().max) bad.push_back(repeated_value(key, 1.1 * key.range.max));
    if (key.numbers > 1) bad.push_back("1 1");
    for (const std::string& value : bad) {
      KeyedRobot robot(is_older(key));
      robot.set(key, value);
      EXPECT_THAT(robot.complaint(), HasSubstr(" = " + value + ", expected " + describe_values(key)))
          << key.path;
    }
  }
}

}  // namespace
}  // namespace koboshi::sim_board
