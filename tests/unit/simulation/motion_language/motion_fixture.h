#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim_board/description/load.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/diagnostic.h"
#include "simulation/motion_language/parse/parse.h"

namespace koboshi::simulation {

// The default robot, read once per program.
inline const NamedModel& koboshi_model() {
  static const NamedModel named =
      load_named_model(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf"));
  return named;
}

// The result of compiling a text.
struct Compiled {
  CompiledMotion motion;
  MotionSource source;
  std::vector<Diagnostic> diagnostics;

  // The codes of all messages in their order: "M010 M012".
  std::string codes() const {
    std::string text;
    for (const Diagnostic& diagnostic : diagnostics) text += (text.empty() ? "" : " ") + diagnostic.code;
    return text;
  }
  std::string messages() const { return print(diagnostics); }
};

inline Compiled compile_text(const std::string& text) {
  Compiled compiled;
  try {
    const MotionFile file = read_motion_text("motion.yaml", text);
    Diagnostics diagnostics(file.path, file.text);
    try {
      compiled.source = parse_motion(file, koboshi_model(), diagnostics);
      compiled.motion = compile_motion(compiled.source, koboshi_model(), diagnostics);
    } catch (const MotionError&) {
    }
    compiled.diagnostics = diagnostics.all();
  } catch (const MotionError& error) {
    compiled.diagnostics = error.diagnostics();
  }
  return compiled;
}

// A file of version 2 with some poses, then `rest`.
inline std::string version_2(const std::string& rest) {
  return "version: 2\nrobot: koboshi\nname: test\n"
         "poses: {bend: {knee: 60}, straight: {others: zero}, roll: {hip_roll: 10, head_pan: 20}}\n" +
         rest;
}

}  // namespace koboshi::simulation
