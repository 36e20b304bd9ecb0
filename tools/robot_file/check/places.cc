#include "tools/robot_file/check/places.h"

namespace koboshi::tools {
namespace {

constexpr std::size_t kDepthOfModel = 2;  // sdf, model

}  // namespace

ModelPlace place_of(const XmlNode& node) {
  ModelPlace place{.line = node.line(), .place = node.place()};
  const std::vector<std::string> path = node.path();
  for (std::size_t i = kDepthOfModel; i < path.size(); ++i)
    place.key += (place.key.empty() ? "" : "/") + path[i];
  if (path.size() <= kDepthOfModel) return place;
  XmlNode element = node;
  for (std::size_t i = path.size() - 1; i > kDepthOfModel; --i) element = *element.parent();
  place.element = element.find_attribute("name").value_or(element.name());
  return place;
}

void set_place(ModelFinding& finding, const ModelPlace& place) {
  finding.line = place.line;
  finding.element = place.element;
  finding.key = place.key;
  finding.place = place.place;
}

std::string other_side(const std::string& element) {
  if (element.starts_with("left_")) return "right_" + element.substr(5);
  if (element.starts_with("right_")) return "left_" + element.substr(6);
  return {};
}

ModelPlaces::ModelPlaces(const XmlNode& sdf) {
  const auto model = sdf.find("model");
  if (!model) return;
  for (const char* kind : {"link", "joint", "koboshi:servo_type"}) {
    for (const XmlNode& node : model->children(kind)) {
      const auto name = node.find_attribute("name");
      if (!name) continue;
      const std::string start = std::string(kind) + " " + *name;
      take(node, start);
      for (const char* part : {"inertial", "axis"})
        if (const auto found = node.find(part)) take(*found, start + " " + part);
      for (const char* shape : {"collision", "visual"})
        for (const XmlNode& part : node.children(shape))
          if (const auto part_name = part.find_attribute("name")) take(part, start + " " + *part_name);
    }
  }
}

const ModelPlace& ModelPlaces::of(const std::string& kind, const std::string& name,
                                  const std::string& part) const {
  const std::string start = kind + " " + name;
  if (const auto found = places_.find(start + " " + part); found != places_.end()) return found->second;
  const auto found = places_.find(start);
  return found == places_.end() ? nowhere_ : found->second;
}

void ModelPlaces::take(const XmlNode& node, const std::string& name) {
  places_.emplace(name, place_of(node));
}

}  // namespace koboshi::tools
