#include "tools/validate/bounce.h"
#include "tools/validate/convergence.h"
#include "tools/validate/free_fall.h"
#include "tools/validate/friction_loop.h"
#include "tools/validate/inverted_pendulum.h"
#include "tools/validate/momentum.h"
#include "tools/validate/pendulum_swing.h"
#include "tools/validate/servo_response.h"
#include "tools/validate/slope.h"
#include "tools/validate/tennis_racket.h"
#include "tools/validate/validation.h"
#include "tools/validate/zmp_comparison.h"

namespace koboshi::tools {

std::vector<Validation> all_validations() {
  return {
      free_fall(),         bounce(),         slope(),         pendulum_swing(), tennis_racket(), momentum(),
      inverted_pendulum(), servo_response(), friction_loop(), zmp_comparison(), convergence()};
}

}  // namespace koboshi::tools
