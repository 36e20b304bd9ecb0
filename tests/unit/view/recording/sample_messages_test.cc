#include "view/recording/sample_messages.h"

#include <foxglove.pb.h>
#include <gtest/gtest.h>
#include <recording.pb.h>

namespace koboshi::view {
namespace {

// The same message by the generated class.
foxglove::FrameTransforms expected_poses(std::uint64_t time_us, const std::vector<Link>& links,
                                         const std::vector<Pose>& poses) {
  foxglove::FrameTransforms message;
  for (std::size_t i = 0; i < links.size(); ++i) {
    foxglove::FrameTransform& transform = *message.add_transforms();
    transform.mutable_timestamp()->set_seconds(static_cast<std::int64_t>(time_us / 1'000'000));
    transform.mutable_timestamp()->set_nanos(static_cast<std::int32_t>(time_us % 1'000'000 * 1000));
    transform.set_parent_frame_id("world");
    transform.set_child_frame_id(links[i].name);
    transform.mutable_translation()->set_x(static_cast<double>(poses[i].p_WL_m.x()));
    transform.mutable_translation()->set_y(static_cast<double>(poses[i].p_WL_m.y()));
    transform.mutable_translation()->set_z(static_cast<double>(poses[i].p_WL_m.z()));
    transform.mutable_rotation()->set_x(static_cast<double>(poses[i].q_WL.x()));
    transform.mutable_rotation()->set_y(static_cast<double>(poses[i].q_WL.y()));
    transform.mutable_rotation()->set_z(static_cast<double>(poses[i].q_WL.z()));
    transform.mutable_rotation()->set_w(static_cast<double>(poses[i].q_WL.w()));
  }
  return message;
}

// The second link's name makes its message longer than 127 bytes, whose length takes two.
const std::vector<Link> kLinks{{.name = "trunk"}, {.name = std::string(150, 'x')}};

TEST(PoseMessages, AreThoseOfTheGeneratedClass) {
  const std::vector<Pose> poses{{{0.1F, -0.2F, 0.3F}, Eigen::Quaternionf(0.5F, -0.5F, 0.5F, 0.5F)},
                                {{1e-9F, 2e9F, -3.0F}, Eigen::Quaternionf(0.6F, 0.8F, 1e-3F, -1e-3F)}};
  const PoseMessages messages("world", kLinks);
  for (const std::uint64_t time_us : {0u, 999'999u, 1'000'000u, 4'294'967'295u}) {
    std::string data = "before";
    messages.append(time_us, poses, data);
    EXPECT_EQ(data, "before" + expected_poses(time_us, kLinks, poses).SerializeAsString()) << time_us;
  }
}

// The generated class omits zeros.
TEST(PoseMessages, KeepZeros) {
  const std::vector<Pose> poses(2);
  std::string data;
  PoseMessages("world", kLinks).append(20'000, poses, data);
  foxglove::FrameTransforms read;
  ASSERT_TRUE(read.ParseFromString(data));
  EXPECT_EQ(read.SerializeAsString(), expected_poses(20'000, kLinks, poses).SerializeAsString());
}

TEST(ContactMessage, IsThatOfTheGeneratedClass) {
  const std::vector<ContactForce> contacts{
      {.link = 3, .other_link = -1, .p_W_m = {0.1F, 0.2F, -0.3F}, .f_W_N = {-1.0F, 2.0F, 30.0F}},
      {.link = 2'000'000'000, .other_link = 7, .p_W_m = {4.0F, 5.0F, 6.0F}, .f_W_N = {7.0F, 8.0F, 9.0F}}};
  koboshi::Contacts expected;
  for (const ContactForce& contact : contacts) {
    koboshi::Contact& message = *expected.add_contacts();
    message.set_link(contact.link);
    message.set_other_link(contact.other_link);
    message.set_x_m(contact.p_W_m.x());
    message.set_y_m(contact.p_W_m.y());
    message.set_z_m(contact.p_W_m.z());
    message.set_force_x_n(contact.f_W_N.x());
    message.set_force_y_n(contact.f_W_N.y());
    message.set_force_z_n(contact.f_W_N.z());
  }
  std::string data;
  append_contacts(contacts, data);
  EXPECT_EQ(data, expected.SerializeAsString());
}

}  // namespace
}  // namespace koboshi::view
