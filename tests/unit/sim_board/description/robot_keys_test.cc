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

// kFullRobot with another sensor in its foot.
std::string with_foot_sensor(const std::string& type, const std::string& keys) {
  std::string text = kFullRobot;
  const std::size_t begin = text.find("<sensor name=\"left_ankle\"");
  const std::string end = "</sensor>";
  text.replace(begin, text.find(end, begin) + end.size() - begin,
               "<sensor name=\"left_ankle\" type=\"" + type +
                   "\"><pose>0 0 -0.01 0 0 0.1</pose><update_rate>500</update_rate>"
                   "<koboshi:jitter_s>0.0002</koboshi:jitter_s>" +
                   keys + "</sensor>");
  return text;
}

const std::string kCells = R"(<koboshi:cell>0.01 0.02</koboshi:cell><koboshi:cell>0.01 -0.02</koboshi:cell>
<koboshi:cell>-0.01 0.02</koboshi:cell><koboshi:cell>-0.01 -0.02</koboshi:cell>
<koboshi:cell_force><noise_density>3e-4</noise_density><bias>0.3</bias><bias_instability>3e-5</bias_instability>
<random_walk>3e-6</random_walk><scale_error>0.05</scale_error><cross_axis>0.04</cross_axis>
<bandwidth_Hz>96</bandwidth_Hz><range>60</range><resolution>0.003</resolution><delay_s>0.002</delay_s>
</koboshi:cell_force>)";

// The variants of kFullRobot that have all keys together.
enum Variant { kNewest, kOlder, kWithCells, kWithSwitch, kVariants };

// Returns one that has the key. Later versions of SDF have another key instead of an older one.
Variant variant_of(const RobotKey& key) {
  if (key.note.source == "SDF 1.6") return kOlder;
  if (key.path.starts_with("joint/sensor/koboshi:cell")) return kWithCells;
  return key.path.starts_with("joint/sensor/koboshi:closing") ? kWithSwitch : kNewest;
}

// kFullRobot with edits of keys that are given by their path in the table.
class KeyedRobot {
 public:
  explicit KeyedRobot(Variant variant) {
    static const std::array<std::string, kVariants> kOriginals{
        original(kFullRobot), original(older_full_robot()),
        original(with_foot_sensor("koboshi:pressure_cells", kCells)),
        original(with_foot_sensor("koboshi:contact_switch",
                                  "<koboshi:closing_force_N>2</koboshi:closing_force_N>"))};
    document_.Parse(kOriginals[variant].c_str());
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
    EXPECT_NE(KeyedRobot(variant_of(key)).find(key), nullptr) << key.path;
  for (int variant = 0; variant < kVariants; ++variant)
    EXPECT_THAT(KeyedRobot(static_cast<Variant>(variant)).text(), HasSubstr("robot | full"));
}

// A key's default, for its element in `robot`.
std::string default_of(KeyedRobot& robot, const RobotKey& key) {
  return key.note.fallback == "mu" ? robot.sibling(key, "mu") : key.note.fallback;
}

// The table says what the reader does without a key; the reader's own defaults are those of description.h.
TEST(RobotKeys, HaveTheDefaultsOfTheReader) {
  for (int variant = 0; variant < kVariants; ++variant) {
    KeyedRobot without(static_cast<Variant>(variant));
    KeyedRobot with_defaults(static_cast<Variant>(variant));
    int defaults = 0;
    for (const RobotKey& key : robot_keys()) {
      if (key.note.fallback.empty() || with_defaults.find(key) == nullptr) continue;
      with_defaults.set(key, default_of(with_defaults, key));
      if (key.name == "pose")
        for (const char* reference : {"relative_to", "frame"})
          with_defaults.find(key)->DeleteAttribute(reference);
      without.remove(key);
      ++defaults;
    }
    EXPECT_GT(defaults, 45);
    EXPECT_EQ(without.text(), with_defaults.text());
  }
}

TEST(RobotKeys, AreOptionalAsTheTableSaysAndHaveAnEffect) {
  for (const RobotKey& key : robot_keys()) {
    KeyedRobot without(variant_of(key));
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
    if (key.numbers > 2) bad.push_back("1 1");
    for (const std::string& value : bad) {
      KeyedRobot robot(variant_of(key));
      robot.set(key, value);
      EXPECT_THAT(robot.complaint(), HasSubstr(" = " + value + ", expected " + describe_values(key)))
          << key.path;
    }
  }
}

}  // namespace
}  // namespace koboshi::sim_board
