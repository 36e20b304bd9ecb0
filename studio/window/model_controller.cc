#include "studio/window/model_controller.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"
#include "studio/controls/run_controller.h"
#include "studio/model/model_panel.h"
#include "studio/view/robot_view.h"
#include "view/capture/scene.h"

namespace koboshi::studio {
namespace {

// The links at joint angles zero, as the file describes them.
std::vector<view::Pose> poses_of_file(const sim_board::RobotDescription& robot) {
  std::vector<view::Pose> links;
  for (const sim_board::LinkDescription& link : robot.links)
    links.push_back({link.X_ML.translation().cast<float>(),
                     Eigen::Quaternionf(Eigen::Matrix3f(link.X_ML.linear().cast<float>()))});
  return links;
}

}  // namespace

ModelController::ModelController(RobotView& view, ModelPanel& panel, RunController& run, QObject* parent)
    : QObject(parent), view_(view), panel_(panel), run_(run) {
  connect(&panel_, &ModelPanel::changed, this, &ModelController::show_shapes);
  connect(&panel_, &ModelPanel::chosen_changed, this, &ModelController::mark_chosen);
  connect(&panel_, &ModelPanel::start_again_requested, this, &ModelController::start_again);
  connect(&view_, &RobotView::picked, this, &ModelController::choose_link);
  connect(&run_, &RunController::opened, this, &ModelController::follow_run);
}

std::optional<QString> ModelController::open(const std::filesystem::path& robot) {
  auto error = panel_.open(robot);
  if (error) return error;
  copies_.emplace(robot, folder_.path().toStdString());
  return std::nullopt;
}

void ModelController::start_again() {
  if (panel_.document() == nullptr) return;
  try {
    run_.set_robot(copies_->write(panel_.document()->text()));
  } catch (const std::exception& error) {
    Q_EMIT failed(QString::fromUtf8(error.what()));
    return;
  }
  Q_EMIT restart_requested();
}

void ModelController::follow_run() {
  std::optional<std::string> text;
  if (run_.session() != nullptr) {
    try {
      text = read_text_file(run_.session()->scenario().robot, "a robot");
      panel_.set_running(text);
    } catch (const InputError&) {
      panel_.set_running({});  // removed since the run began
    }
  } else {
    panel_.set_running({});
  }
  show_shapes();
}

// The poses stay those of the run: what an edit means for the motion, only another run shows.
void ModelController::show_shapes() {
  const ModelDocument* document = panel_.document();
  if (document == nullptr || run_.bus() != nullptr) return;
  if (run_.session() == nullptr && !run_.recording().scene.links.empty()) return;  // a recording has its own
  view::Scene scene = view::make_scene(document->robot(), sim_board::GroundDescription());
  if (run_.session() == nullptr) {
    view_.change().set_shapes(std::move(scene), document->robot());
    if (view_.picture().posed().empty()) view_.show_robot(poses_of_file(document->robot()), {});
    return;
  }
  view::Scene shown = run_.recording().scene;
  const bool is_same = std::ranges::equal(shown.links, scene.links, {}, &view::Link::name, &view::Link::name);
  if (!is_same) return;  // another robot runs
  shown.links = std::move(scene.links);
  view_.change().set_shapes(std::move(shown), document->robot());
}

void ModelController::choose_link(int link) {
  const auto& links = view_.picture().scene().links;
  if (link >= 0 && static_cast<std::size_t>(link) < links.size())
    panel_.choose(QString::fromStdString(links[static_cast<std::size_t>(link)].name));
  mark_chosen();
}

// A joint is shown at the link that it moves.
void ModelController::mark_chosen() {
  const std::string chosen = panel_.chosen().toStdString();
  if (panel_.document() == nullptr) return view_.change().set_chosen_link(-1);
  const sim_board::RobotDescription& robot = panel_.document()->robot();
  std::optional<int> link = robot.find_link(chosen);
  if (const auto joint = robot.find_joint(chosen))
    link = robot.joints[static_cast<std::size_t>(*joint)].child;
  view_.change().set_chosen_link(link.value_or(-1));
}

}  // namespace koboshi::studio
