#include "tools/import/read/mjcf_subset.h"

#include <tinyxml2.h>

#include <algorithm>
#include <locale>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "base/xml/xml_draft.h"
#include "base/xml/xml_reader.h"
#include "tools/import/read/xml_values.h"

namespace koboshi::tools {
namespace {

using tinyxml2::XMLElement;
using Names = std::set<std::string_view>;

constexpr std::size_t kMaxIncludes = 100;

// Attributes that the import reads, all of them known to MuJoCo 2.2.
const std::map<std::string_view, Names>& attributes() {
  static const std::map<std::string_view, Names> table{
      {"mujoco", {"model"}},
      {"compiler",
       {"autolimits", "boundmass", "boundinertia", "settotalmass", "balanceinertia", "strippath", "angle",
        "eulerseq", "meshdir", "inertiafromgeom", "inertiagrouprange", "exactmeshinertia", "coordinate"}},
      {"default", {"class"}},
      {"asset", {}},
      {"mesh", {"name", "class", "file", "vertex", "face", "normal", "refpos", "refquat", "scale"}},
      {"material", {"name", "class", "rgba"}},
      {"worldbody", {}},
      {"body", {"name", "childclass", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler"}},
      {"inertial",
       {"pos", "quat", "mass", "diaginertia", "axisangle", "xyaxes", "zaxis", "euler", "fullinertia"}},
      {"joint",
       {"name", "class", "type", "pos", "axis", "limited", "range", "ref", "armature", "damping",
        "frictionloss"}},
      {"freejoint", {"name"}},
      {"geom", {"name",      "class",  "type",    "contype",      "conaffinity", "group",    "size",
                "material",  "mass",   "density", "shellinertia", "fromto",      "pos",      "quat",
                "axisangle", "xyaxes", "zaxis",   "euler",        "mesh",        "fitscale", "rgba"}},
      {"site", {"name", "class", "pos", "quat", "fromto", "axisangle", "xyaxes", "zaxis", "euler"}},
      {"actuator", {}},
      {"general",
       {"name", "class", "ctrllimited", "forcelimited", "ctrlrange", "forcerange", "gear", "joint",
        "jointinparent", "gainprm", "biastype"}},
      {"motor",
       {"name", "class", "ctrllimited", "forcelimited", "ctrlrange", "forcerange", "gear", "joint",
        "jointinparent"}},
      {"position",
       {"name", "class", "ctrllimited", "forcelimited", "ctrlrange", "forcerange", "gear", "joint",
        "jointinparent", "kp"}},
      {"velocity",
       {"name", "class", "ctrllimited", "forcelimited", "ctrlrange", "forcerange", "gear", "joint",
        "jointinparent"}},
  };
  return table;
}

// Elements without a counterpart in a robot's file, by the element around them.
bool is_left_out(std::string_view parent, std::string_view name) {
  static const Names sections{"option",   "size",   "visual",    "statistic",  "contact",  "sensor",
                              "keyframe", "custom", "extension", "deformable", "equality", "tendon"};
  static const Names in_body{"camera", "light", "plugin", "composite", "flexcomp"};
  static const Names in_default{"camera", "light", "pair", "equality", "tendon"};
  static const Names in_asset{"texture", "hfield", "skin", "model"};
  if (parent == "mujoco") return sections.contains(name);
  if (parent == "worldbody" || parent == "body") return in_body.contains(name);
  if (parent == "default") return in_default.contains(name);
  if (parent == "asset") return in_asset.contains(name);
  return true;  // a layer of a material, a plugin of a mesh
}

bool is_in(std::string_view parent, std::string_view name) {
  static const std::map<std::string_view, Names> children{
      {"mujoco", {"compiler", "default", "asset", "worldbody", "actuator"}},
      {"default",
       {"default", "mesh", "material", "joint", "geom", "site", "general", "motor", "position", "velocity"}},
      {"asset", {"mesh", "material"}},
      {"worldbody", {"body", "geom", "site", "joint", "freejoint", "inertial"}},
      {"body", {"body", "geom", "site", "joint", "freejoint", "inertial"}},
      {"actuator", {"general", "motor", "position", "velocity"}},
  };
  const auto found = children.find(parent);
  return found != children.end() && found->second.contains(name);
}

class SubsetMaker {
 public:
  SubsetMaker(const std::filesystem::path& file, ImportReport& report) : file_(file), report_(report) {}

  MjcfSubset make(const std::string& text) {
    const XMLElement& root = parse(file_, text);
    XMLElement* const copy = output_.NewElement("mujoco");
    output_.InsertEndChild(copy);
    if (const char* const model = root.Attribute("model")) copy->SetAttribute("model", model);
    lines_.push_back(root.GetLineNum());
    add("size", root.GetLineNum(), *copy)->SetAttribute("nuser_jnt", 2);
    copy_children(root, *copy);
    if (!has_autolimits_) add("compiler", root.GetLineNum(), *copy)->SetAttribute("autolimits", "true");
    finish_loops();
    print();
    return std::move(subset_);
  }

 private:
  const XMLElement& parse(const std::filesystem::path& file, const std::string& text) {
    const std::string name = xml_root_name(file);
    sources_.push_back(
        std::make_unique<XmlDraft>(file, text, XmlRule{.name = name.empty() ? "mujoco" : name}));
    return sources_.back()->root().element();
  }

  [[noreturn]] void refuse(const XMLElement& element, const std::string& found,
                           const std::string& expected) const {
    throw InputError(place(element), element.GetLineNum(), found, expected);
  }
  // The file that an element is in.
  const std::filesystem::path& place(const XMLElement& element) const {
    for (const auto& source : sources_)
      if (source->root().element().GetDocument() == element.GetDocument()) return source->path();
    return file_;
  }

  XMLElement* add(const char* name, int line, XMLElement& parent) {
    XMLElement* const element = output_.NewElement(name);
    parent.InsertEndChild(element);
    lines_.push_back(line);
    return element;
  }

  void copy_children(const XMLElement& from, XMLElement& to) {
    for (const XMLElement* child = from.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement())
      copy(*child, to);
  }

  void copy(const XMLElement& from, XMLElement& to) {
    const std::string_view parent = to.Name();
    const std::string_view name = from.Name();
    if (name == "include") return include(from, to);
    if (name == "frame" && (parent == "body" || parent == "worldbody")) return copy_frame(from, to);
    if (parent == "mujoco") read_section(from);
    if (parent == "actuator" || (parent == "default" && is_actuator(name))) return copy_actuator(from, to);
    if (is_in(parent, name)) return copy_element(from, from.Name(), to);
    if (is_left_out(parent, name)) return;
    if (parent == "worldbody" || parent == "body")
      refuse(from, "<" + one_line(from.Name()) + "> in a body",
             "bodies, joints and geoms; a newer MuJoCo writes the others out: compile model.xml out.xml");
    report_.ignored.push_back("line " + std::to_string(from.GetLineNum()) + ": <" + one_line(from.Name()) +
                              ">");
  }

  void include(const XMLElement& from, XMLElement& to) {
    const char* const name = from.Attribute("file");
    if (name == nullptr) refuse(from, "<include> without a file", "the name of an MJCF file");
    const std::filesystem::path file = file_.parent_path() / name;
    if (sources_.size() > kMaxIncludes || !included_.insert(file.lexically_normal().string()).second)
      refuse(from, "<include> of " + one_line(name), "each file at most once, as MuJoCo has it");
    copy_children(parse(file, with_line_feeds(read_text_file(file, "an MJCF file"))), to);
  }

  // A frame moves what is in it, as a body without a joint does; in the world, its place does not matter.
  void copy_frame(const XMLElement& from, XMLElement& to) {
    if (std::string_view(to.Name()) == "worldbody") return copy_children(from, to);
    for (const char* const name : {"joint", "freejoint", "inertial"})
      if (const XMLElement* const child = from.FirstChildElement(name))
        refuse(*child, "<" + std::string(name) + "> in a frame", "one in the body itself");
    copy_element(from, "body", to);
  }

  static bool is_actuator(std::string_view name) {
    static const Names all{"general", "motor",    "position", "velocity", "intvelocity",
                           "damper",  "cylinder", "muscle",   "adhesion", "dcmotor"};
    return all.contains(name);
  }

  // Of an actuator, the import reads which joint it drives and how strongly.
  void copy_actuator(const XMLElement& from, XMLElement& to) {
    const bool is_default = std::string_view(to.Name()) == "default";
    if (!is_default && from.Attribute("joint") == nullptr && from.Attribute("jointinparent") == nullptr)
      return;
    copy_element(from, attributes().contains(from.Name()) ? from.Name() : "general", to);
  }

  void copy_element(const XMLElement& from, const char* name, XMLElement& to) {
    if (is_of_height_field(from)) return;
    XMLElement* const element = add(name, from.GetLineNum(), to);
    const auto known = attributes().find(name);
    for (const tinyxml2::XMLAttribute* attribute = from.FirstAttribute(); attribute != nullptr;
         attribute = attribute->Next()) {
      if (known->second.contains(attribute->Name()))
        element->SetAttribute(attribute->Name(), attribute->Value());
      else if (std::string_view(attribute->Name()) == "actuatorfrcrange")
        element->SetAttribute("user", attribute->Value());
      else if (std::string_view(attribute->Name()) == "assetdir" && from.Attribute("meshdir") == nullptr)
        element->SetAttribute("meshdir", attribute->Value());
    }
    has_autolimits_ = has_autolimits_ || element->Attribute("autolimits") != nullptr;
    if (std::string_view(name) == "site") note_site(from, to);
    if (const char* const own = from.Attribute("name")) {
      if (std::string_view(name) == "joint") subset_.joint_lines[own] = from.GetLineNum();
      if (std::string_view(name) == "body") subset_.body_lines[own] = from.GetLineNum();
    }
    copy_children(from, *element);
  }

  static bool is_of_height_field(const XMLElement& element) {
    const char* const type = element.Attribute("type");
    return std::string_view(element.Name()) == "geom" && type != nullptr &&
           (std::string_view(type) == "hfield" || std::string_view(type) == "sdf");
  }

  void note_site(const XMLElement& site, const XMLElement& body) {
    const char* const name = site.Attribute("name");
    const char* const of = body.Attribute("name");
    if (name != nullptr && of != nullptr) body_of_site_[name] = of;
  }

  void read_section(const XMLElement& section) {
    const std::string_view name = section.Name();
    for (const XMLElement* child = section.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      if (name == "tendon") ++subset_.tendons;
      if (name == "equality") read_equality(*child);
    }
  }

  static std::string text_of(const XMLElement& element, const char* attribute) {
    const char* const value = element.Attribute(attribute);
    return value == nullptr ? std::string() : value;
  }

  void read_equality(const XMLElement& equality) {
    const std::string_view kind = equality.Name();
    if (kind == "connect" || kind == "weld") {
      const bool has_sites = equality.Attribute("site1") != nullptr;
      loops_.push_back({{text_of(equality, has_sites ? "site1" : "body1"),
                         text_of(equality, has_sites ? "site2" : "body2")},
                        has_sites});
    }
    if (kind != "joint" || equality.Attribute("joint2") == nullptr) return;
    MjcfCoupling coupling{.joint = text_of(equality, "joint1"), .of = text_of(equality, "joint2")};
    // The polynomial c0 + c1 x + ...; its linear coefficient is the ratio.
    std::istringstream coefficients(text_of(equality, "polycoef"));
    coefficients.imbue(std::locale::classic());
    if (!(coefficients >> coupling.offset_rad >> coupling.ratio)) coupling.ratio = 1.0;
    subset_.couplings.push_back(std::move(coupling));
  }

  void finish_loops() {
    for (const auto& [loop, has_sites] : loops_) {
      const auto body = [this, by_site = has_sites](const std::string& name) {
        const auto found = body_of_site_.find(name);
        return by_site ? (found == body_of_site_.end() ? std::string() : found->second) : name;
      };
      subset_.loops.push_back({body(loop.one), body(loop.other)});
    }
  }

  // The printer writes each element on a line of its own.
  void print() {
    tinyxml2::XMLPrinter printer;
    output_.Print(&printer);
    subset_.text = printer.CStr();
    subset_.lines.push_back(0);
    std::size_t next = 0;
    for (std::size_t begin = 0; begin < subset_.text.size();) {
      const std::size_t end = std::min(subset_.text.find('\n', begin), subset_.text.size());
      const std::size_t start = subset_.text.find_first_not_of(' ', begin);
      const bool opens =
          start < end && subset_.text[start] == '<' && subset_.text[start + 1] != '/' && next < lines_.size();
      subset_.lines.push_back(opens ? lines_[next++] : subset_.lines.back());
      begin = end + 1;
    }
  }

  const std::filesystem::path& file_;
  ImportReport& report_;
  MjcfSubset subset_;
  tinyxml2::XMLDocument output_;
  std::vector<int> lines_;  // of the source, by element of output_
  std::vector<std::unique_ptr<XmlDraft>> sources_;
  std::set<std::string> included_;
  std::map<std::string, std::string> body_of_site_;
  std::vector<std::pair<MjcfLoop, bool>> loops_;  // true: between sites
  bool has_autolimits_ = false;
};

}  // namespace

MjcfSubset mjcf_subset(const std::filesystem::path& file, const std::string& text, ImportReport& report) {
  return SubsetMaker(file, report).make(text);
}

}  // namespace koboshi::tools
