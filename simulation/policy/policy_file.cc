#include "simulation/policy/policy_file.h"

#include <fmt/format.h>

#include <array>
#include <span>
#include <string_view>

#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi::simulation {
namespace {

// By PolicyStatus.
constexpr std::array<std::string_view, 15> kPolicyStatusTexts = {
    "a policy",
    "fewer bytes than its header says",
    "no policy image",
    "a policy image of another version",
    "a policy image whose size does not fit its contents",
    "a policy image with a wrong checksum",
    "a policy for another robot model",
    "a policy with a count out of range",
    "a policy without a printable name",
    "input {} with an unknown signal or a bad range",
    "output {} with a joint that is no hip or ankle, or a scale, bound or rate out of range",
    "layer {} with a size, function or scale that a layer cannot have",
    "layer {} with a bias out of range",
    "a policy that takes more instructions than a tick has room for",
    "a policy at an address that is no multiple of 4",
};

}  // namespace

std::string describe(const policy::PolicyVerdict& verdict) {
  return fmt::format(fmt::runtime(kPolicyStatusTexts.at(static_cast<std::size_t>(verdict.status))),
                     verdict.index);
}

std::vector<std::byte> read_policy_image(const std::filesystem::path& file, const robot::RobotModel& model) {
  const std::string text = read_text_file(file, "the image of a policy");
  const auto bytes = std::as_bytes(std::span(text));
  std::vector<std::byte> image(bytes.begin(), bytes.end());  // at an aligned address
  policy::Policy policy;
  const policy::PolicyVerdict verdict = policy::Policy::open(image, model, policy);
  if (!verdict.ok()) throw InputError(file, 0, describe(verdict), "a policy for this robot");
  if (policy.image_size_bytes() != image.size())
    throw InputError(file, 0, "bytes after the image", "one policy image");
  return image;
}

}  // namespace koboshi::simulation
