#include "tools/lab/validate/bounce.h"
#include "tools/lab/validate/convergence.h"
#include "tools/lab/validate/free_fall.h"
#include "tools/lab/validate/friction_loop.h"
#include "tools/lab/validate/inverted_pendulum.h"
#include "tools/lab/validate/momentum.h"
#include "tools/lab/validate/pendulum_swing.h"
#include "tools/lab/validate/servo_response.h"
#include "tools/lab/validate/slope.h"
#include "tools/lab/validate/tennis_racket.h"
#include "tools/lab/validate/validation.h"
#include "tools/lab/validate/zmp_comparison.h"

namespace koboshi::tools {

std::vector<Validation> all_validations() {
  return {
      free_fall(),         bounce(),         slope(),         pendulum_swing(), tennis_racket(), momentum(),
      inverted_pendulum(), servo_response(), friction_loop(), zmp_comparison(), convergence()};
}

}  // namespace koboshi::tools
