#pragma once

#include <cmath>
#include <cstdint>

#include "view/recording/recording.h"

namespace koboshi::test {

// A recording with all its parts: a trunk of a box and a foot of a mesh, which slide and turn for
// `samples` ticks of 10 ms over a plane with a ramp; contacts, a push, events and frames.
inline view::Recording sample_recording(std::size_t samples = 300) {
  view::Recording recording;
  recording.title = "sample";
  recording.scenario = "version: 1\nrobot: sample.sdf\n";
  recording.seed = 7;
  recording.stepper = "lumped";
  recording.version = "1.2.3";

  recording.nodes = {{1, "controller"}, {16, "left \"knee\""}};

  view::Scene& scene = recording.scene;
  scene.robot = "sample";
  view::Link trunk{.name = "trunk", .mass_kg = 1.5, .p_LCom_L = {0.0, 0.01, 0.05}};
  trunk.visuals.push_back(
      {.name = "body", .geometry = view::Box{{0.1, 0.08, 0.2}}, .colour = {0.2F, 0.4F, 0.8F}});
  trunk.visuals.back().X_LG.translation().z() = 0.05;
  trunk.collisions = trunk.visuals;
  view::Link foot{.name = "left_foot", .parent = 0, .mass_kg = 0.25};
  foot.visuals.push_back(
      {.name = "shell",
       .geometry =
           view::Mesh{{{0.0F, 0.0F, 0.0F}, {0.1F, 0.0F, 0.0F}, {0.0F, 0.1F, 0.0F}, {0.0F, 0.0F, 0.03F}},
                      {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}},
       .colour = {0.9F, 0.9F, 0.9F}});
  foot.collisions.push_back({.name = "sole", .geometry = view::Box{{0.1, 0.06, 0.03}}});
  scene.links = {trunk, foot};
  scene.planes = {{}};
  view::Shape ramp{.name = "ramp", .geometry = view::Box{{1.0, 0.5, 0.1}}};
  ramp.X_LG.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()).toRotationMatrix();
  scene.ground = {ramp};
  scene.soles_L[0] = {
      {-0.05, -0.03, -0.015}, {0.05, -0.03, -0.015}, {0.05, 0.03, -0.015}, {-0.05, 0.03, -0.015}};
  scene.sole_links = {1, -1};

  recording.signals = {{.name = "state_name", .names = {{0, "boot"}, {2, "standing"}, {3, "going down"}}},
                       {.name = "left_load", .unit = "N"},
                       {.name = "emergencies"}};
  for (std::size_t i = 1; i <= samples; ++i) {
    const auto time_us = static_cast<std::uint64_t>(10'000 * i);
    const float phase = 0.01F * static_cast<float>(i);
    const auto turn = Eigen::Quaternionf(Eigen::AngleAxisf(2.0F * phase, Eigen::Vector3f::UnitZ()));
    view::Sample sample{.time_us = time_us};
    sample.links = {{{phase, 0.0F, 0.3F}, turn}, {{phase, 0.05F, 0.015F + 0.01F * std::sin(phase)}, turn}};
    sample.contacts = {{.link = 1, .p_W_m = {phase, 0.05F, 0.0F}, .f_W_N = {0.1F, -0.2F, 15.0F + phase}},
                       {.link = 1, .other_link = 0, .f_W_N = {1.0F, 0.0F, 0.0F}}};
    sample.values = {i < 100 ? 0.0F : 2.0F, 15.0F + phase, static_cast<float>(i / 100)};
    recording.samples.push_back(std::move(sample));
    recording.frames.push_back({time_us - 3'000, {.identifier = 0x181, .size = 2, .data = {0x37, 0x02}}});
    recording.frames.push_back({time_us - 1'234, {.identifier = 0x701, .size = 1, .remote = true}});
  }
  recording.events = {{500'000, "state", "Stands."}, {1'200'000, "push", "The trunk is pushed."}};
  recording.pushes = {
      {.start_us = 1'200'000, .end_us = 1'300'000, .p_L_m = {0.0, 0.0, 0.1}, .f_W_N = {5.0, 0.0, 0.0}}};
  return recording;
}

}  // namespace koboshi::test
