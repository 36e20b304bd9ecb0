#include "studio/plot/plot_style.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace koboshi::studio {
namespace {

constexpr std::array<QRgb, 8> kLightTraces{0xff0072b2, 0xffd55e00, 0xff00825f, 0xffb2467f,
                                           0xff8a6a00, 0xff3b9bd6, 0xff5b4bc4, 0xff555555};
constexpr std::array<QRgb, 8> kDarkTraces{0xff56b4e9, 0xfff08c3c, 0xff2fc79a, 0xffe892c0,
                                          0xfff0e442, 0xff7aa5ff, 0xffb7a4ff, 0xffc0c4cc};

constexpr std::pair<const char*, QRgb> kStates[] = {
    {"boot", 0xff6b7280},        {"limp", 0xff9aa1ab},        {"enabling", 0xff8ecdf0},
    {"soft start", 0xff56b4e9},  {"standing", 0xff12a37b},    {"motion", 0xff0072b2},
    {"walking", 0xff3a5fd0},     {"fault", 0xff7a1022},       {"emergency stop", 0xffb00020},
    {"low battery", 0xffa8963a}, {"falling", 0xffd55e00},     {"fallen", 0xffb2467f},
    {"righting", 0xffe69f00},    {"rolling", 0xfff2c14e},     {"rising", 0xfff0e442},
    {"steadying", 0xffc9d94e},   {"sitting down", 0xff8c7a1f}};

constexpr std::pair<const char*, const char*> kUnits[] = {
    {"rad_per_s", "rad/s"}, {"permille", "‰"}, {"m_per_s", "m/s"}, {"m_per_s2", "m/s²"},
    {"Nm", "N m"},          {"degC", "°C"},    {"deg", "°"}};

constexpr double kDegrees = 57.29577951308232;
constexpr double kMaxInMillimetres = 0.5;

QColor mixed(const QColor& one, const QColor& other, double share) {
  const auto mix = [share](int a, int b) { return static_cast<int>(std::lround(a + share * (b - a))); };
  return {mix(one.red(), other.red()), mix(one.green(), other.green()), mix(one.blue(), other.blue())};
}

}  // namespace

PlotStyle::PlotStyle(const QPalette& palette)
    : dark(palette.color(QPalette::Base).lightness() < 128),
      background(palette.color(QPalette::Base)),
      ink(palette.color(QPalette::Text)),
      dim(mixed(ink, background, 0.35)),
      rule(mixed(background, ink, dark ? 0.16 : 0.11)),
      zero(mixed(background, ink, dark ? 0.4 : 0.35)),
      cursor(dark ? 0xffff5c6c : 0xffd0021b),
      warning(dark ? 0xfff08c3c : 0xffd55e00) {}

QColor PlotStyle::trace(int index) const {
  const std::span<const QRgb> colours = trace_colours(dark);
  return QColor::fromRgb(colours[static_cast<std::size_t>(index) % colours.size()]);
}

std::span<const QRgb> trace_colours(bool dark) { return dark ? kDarkTraces : kLightTraces; }

QColor state_colour(const QString& name, int index) {
  const QString words = QString(name).replace(QLatin1Char('_'), QLatin1Char(' '));
  for (const auto& [state, colour] : kStates)
    if (words == QLatin1String(state)) return QColor::fromRgb(colour);
  return QColor::fromRgb(kLightTraces[static_cast<std::size_t>(index) % kLightTraces.size()]);
}

QColor ink_on(const QColor& colour) {
  const double luma = 0.299 * colour.red() + 0.587 * colour.green() + 0.114 * colour.blue();
  return luma > 140.0 ? QColor(0x11, 0x11, 0x11) : QColor(Qt::white);
}

ShownUnit shown_unit(const std::string& unit, double max_magnitude) {
  if (unit == "rad") return {kDegrees, QStringLiteral("°")};
  if (unit == "rad_per_s") return {kDegrees, QStringLiteral("°/s")};
  if (unit == "m" && max_magnitude <= kMaxInMillimetres) return {1000.0, QStringLiteral("mm")};
  for (const auto& [recorded, text] : kUnits)
    if (unit == recorded) return {1.0, QString::fromUtf8(text)};
  return {1.0, QString::fromStdString(unit)};
}

double nice_step(double range, double count) {
  const double rough = range / std::max(1.0, count);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough * (1.0 - 1e-9)) return factor * power;
  return 10.0 * power;
}

int decimals_of(double step) {
  return std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 9);
}

QString number_text(double value, int decimals) {
  if (!std::isfinite(value)) return QStringLiteral("–");
  const double magnitude = std::abs(value);
  QString text = magnitude >= 1e7 ? QString::number(value, 'e', 3) : QString::number(value, 'f', decimals);
  const bool is_zero =
      std::ranges::all_of(text, [](QChar c) { return !c.isDigit() || c == QLatin1Char('0'); });
  if (is_zero) return text.remove(QLatin1Char('-'));
  return text.replace(QLatin1Char('-'), QChar(0x2212));
}

QString value_text(const view::Signal& signal, float value, const ShownUnit& unit, int decimals) {
  for (const auto& [number, name] : signal.names)
    if (static_cast<float>(number) == value) return QString::fromStdString(name);
  const QString number = number_text(unit.factor * static_cast<double>(value), decimals);
  if (!std::isfinite(value) || unit.text.isEmpty()) return number;
  const bool is_degrees = unit.text == QStringLiteral("°");
  return is_degrees ? number + unit.text : number + QChar(0x00a0) + unit.text;
}

}  // namespace koboshi::studio
