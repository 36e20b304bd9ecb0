#include "tools/motion_edit/sensor_text.h"

#include <cctype>

namespace koboshi::tools {
namespace {

using simulation::Sensor;

bool is_word_letter(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_';
}

std::size_t word_end(std::string_view text, std::size_t begin) {
  while (begin < text.size() && is_word_letter(text[begin])) ++begin;
  return begin;
}

}  // namespace

std::string replace_sensors(std::string_view text,
                            const std::function<SensorText(const Sensor&, std::string_view)>& image) {
  std::string result;
  // Whether the last token ends an operand, so that a minus after it subtracts.
  bool after_operand = false;
  constexpr std::size_t kNone = std::string::npos;
  std::size_t sign = kNone;  // place in `result` of a unary minus directly before this token
  for (std::size_t i = 0; i < text.size();) {
    if (!is_word_letter(text[i])) {
      const char letter = text[i++];
      if (letter == '-' && !after_operand) {
        sign = result.size();
      } else if (letter != ' ') {
        sign = kNone;
      }
      // The quotes around the text are not part of it.
      if (letter != ' ' && letter != '"' && letter != '\'') after_operand = letter == ')';
      result += letter;
      continue;
    }
    const std::size_t end = word_end(text, i);
    std::string word(text.substr(i, end - i));
    i = end;
    const bool is_operator = word == "and" || word == "or" || word == "not";
    bool opposite = false;
    if (const Sensor* sensor = simulation::find_sensor(std::string_view(word))) {
      std::string_view joint;
      std::size_t begin = i;
      const std::size_t open = text.find_first_not_of(' ', i);
      if (sensor->index == Sensor::Index::kJoint && open != std::string_view::npos && text[open] == '(') {
        begin = open + 1;
        while (begin < text.size() && !is_word_letter(text[begin])) ++begin;
        joint = text.substr(begin, word_end(text, begin) - begin);
      }
      const SensorText replaced = image(*sensor, joint);
      word = replaced.sensor;
      opposite = replaced.is_opposite;
      if (!joint.empty()) {
        word += std::string(text.substr(i, begin - i)) + replaced.joint;
        i = begin + joint.size();
      }
    }
    if (opposite && sign != kNone) {
      result.erase(sign, 1);
    } else if (opposite) {
      word.insert(0, "-");
    }
    result += word;
    sign = kNone;
    after_operand = !is_operator;
  }
  return result;
}

}  // namespace koboshi::tools
