#include "studio/window/plant_controller.h"

#include <QLabel>
#include <filesystem>
#include <vector>

#include "studio/controls/run_controller.h"
#include "studio/plant/plant_panel.h"
#include "studio/view/robot_view.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

bool is_same_file(const fs::path& one, const fs::path& other) {
  std::error_code ignored;
  return fs::equivalent(one, other, ignored);
}

}  // namespace

PlantController::PlantController(RobotView& view, PlantPanel& panel, RunController& run, QObject* parent)
    : QObject(parent), view_(view), panel_(panel), run_(run), differences_(new QLabel(&view)) {
  differences_->setObjectName(QStringLiteral("plant_differences"));
  differences_->setTextFormat(Qt::PlainText);
  differences_->setAttribute(Qt::WA_TransparentForMouseEvents);
  differences_->setAutoFillBackground(true);
  differences_->setMargin(4);
  differences_->move(8, 8);
  differences_->hide();
  connect(&run_, &RunController::opened, this, &PlantController::follow_run);
  connect(&panel_, &PlantPanel::start_again_requested, this, &PlantController::restart_requested);
  connect(&panel_, &PlantPanel::open_requested, this,
          [this](const QString& file) { run_.open_scenario(fs::path(file.toStdString())); });
  connect(&view_, &RobotView::picked, this, [this](int link) {
    const auto& links = view_.picture().scene().links;
    if (link >= 0 && static_cast<std::size_t>(link) < links.size())
      panel_.choose(QString::fromStdString(links[static_cast<std::size_t>(link)].name));
  });
  run_.set_edits([&panel](const fs::path& scenario) -> std::vector<Override> {
    if (!panel.modified() || !is_same_file(panel.document()->file(), scenario)) return {};
    return {panel.document()->override_value()};
  });
}

// The run of a motion has a scenario that nobody has opened.
void PlantController::follow_run() {
  panel_.set_running({});
  if (run_.session() != nullptr) {
    const simulation::Scenario& scenario = run_.session()->scenario();
    if (is_same_file(scenario.file, run_.file())) {
      panel_.open(scenario.file, scenario.robot);
      const bool is_shown =
          panel_.document() != nullptr && is_same_file(panel_.document()->file(), scenario.file);
      if (is_shown) panel_.set_running(scenario.plant);
    }
  }
  show_differences();
}

void PlantController::show_differences() {
  constexpr qsizetype kMaxLines = 8;
  QStringList lines = panel_.differences().split(QLatin1Char('\n'), Qt::SkipEmptyParts);
  const qsizetype more = lines.size() - kMaxLines;
  if (more > 0) lines = lines.first(kMaxLines) << tr("and %1 more").arg(more);
  if (!lines.isEmpty()) lines.prepend(tr("Unlike the firmware's model:"));
  differences_->setText(lines.join(QLatin1Char('\n')));
  differences_->adjustSize();
  differences_->setVisible(!lines.isEmpty());
}

}  // namespace koboshi::studio
