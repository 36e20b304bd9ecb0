#include "sim_board/description/load.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/compile/decompile.h"
#include "simulation/motion_language/parse/parse.h"
#include "tests/fuzz/fuzz_input.h"

// A motion's source (YAML). One that compiles must decompile to a source with the same image.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  using namespace koboshi::simulation;
  static const NamedModel robot =
      load_named_model(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf"));
  const auto compiled = [](std::string text) {
    return fuzz::read_or_refuse([&] {
      const MotionFile file = read_motion_text("motion.yaml", std::move(text));
      Diagnostics diagnostics("motion.yaml");
      const MotionSource source = parse_motion(file, robot, diagnostics);
      return compile_motion(source, robot, diagnostics).image;
    });
  };
  const auto image = compiled(std::string(fuzz::text_of({data, size})));
  if (!image || image->empty()) return 0;
  const auto again = compiled(decompile_motion(*image, robot, "motion.kmot"));
  if (again != image) __builtin_trap();
  return 0;
}
