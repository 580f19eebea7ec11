// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/format.h"

#include <cmath>

#include <QRegularExpression>

namespace alidade {

namespace {

constexpr QChar kNarrowSpace(0x202F);
}  // namespace

QString withMinus(QString number) {
  return number.replace('-', kMinus);
}

QString reportText(const std::string& utf8) {
  static const QRegularExpression hyphen(QStringLiteral("(?<![\\w-])-(?=\\d)"));
  return text(utf8).replace(hyphen, QString(kMinus));
}

QString formatNumber(double value, int decimals) {
  if (!std::isfinite(value)) return QStringLiteral("–");
  const QString figure = QString::number(std::abs(value), 'f', decimals);
  return std::signbit(value) && figure.toDouble() != 0 ? kMinus + figure : figure;
}

QString formatCoordinate(double metres) {
  if (!std::isfinite(metres)) return QStringLiteral("–");
  QString number = QString::number(std::abs(metres), 'f', 3);
  for (int i = static_cast<int>(number.indexOf('.')) - 3; i > 0; i -= 3) number.insert(i, kNarrowSpace);
  return std::signbit(metres) ? kMinus + number : number;
}

QString formatWorld(const glm::dvec3& world) {
  return QStringLiteral("E %1  N %2  H %3 m")
      .arg(formatCoordinate(world.x), formatCoordinate(world.y), formatCoordinate(world.z));
}

QString formatPixel(const glm::dvec2& pixel) {
  return withMinus(QStringLiteral("%1, %2 px").arg(pixel.x, 0, 'f', 1).arg(pixel.y, 0, 'f', 1));
}

QString formatCount(std::uint64_t count) {
  const double n = static_cast<double>(count);
  if (n >= 99.5e6) return QStringLiteral("%1 M").arg(n / 1e6, 0, 'f', 0);
  if (n >= 999.5e3) return QStringLiteral("%1 M").arg(n / 1e6, 0, 'f', 1);
  if (n >= 1e4) return QStringLiteral("%1 k").arg(n / 1e3, 0, 'f', 0);
  return QString::number(count);
}

QString formatPointsOf(std::uint64_t drawn, std::uint64_t total) {
  if (total == 0) return QStringLiteral("no points");
  return QStringLiteral("%1 of %2 points").arg(formatCount(drawn), formatCount(total));
}

QString formatMillimetres(double metres) {
  if (!std::isfinite(metres)) return QStringLiteral("– mm");
  if (std::abs(metres) >= 1.0) return withMinus(QStringLiteral("%1 m").arg(metres, 0, 'f', 2));
  const double mm = metres * 1000.0;
  return withMinus(QStringLiteral("%1 mm").arg(mm, 0, 'f', std::abs(mm) < 9.95 ? 1 : 0));
}

QString formatDistance(double metres) {
  if (!std::isfinite(metres)) return QStringLiteral("– m");
  return withMinus(QStringLiteral("%1 m").arg(metres, 0, 'f', std::abs(metres) < 1000 ? 2 : 0));
}

QString formatSeconds(double secs) {
  return withMinus(QStringLiteral("%1 s").arg(secs, 0, 'f', 2));
}

QString formatPercent(double fraction) {
  return QStringLiteral("%1 %").arg(fraction * 100.0, 0, 'f', 0);
}

QString poseSourceName(PoseSource source) {
  switch (source) {
    case PoseSource::None:
      return QStringLiteral("No pose");
    case PoseSource::File:
      return QStringLiteral("From file");
    case PoseSource::Interpolated:
      return QStringLiteral("Interpolated");
    case PoseSource::Refined:
      return QStringLiteral("Refined");
  }
  return {};
}

double poseMillimetresAt(const Frame& frame, double distanceM) {
  if (!frame.quality || frame.quality->observations == 0) return -1;
  const glm::dvec3& p = frame.quality->positionStdM;
  const glm::dvec3& r = frame.quality->rotationStdRad;
  const double acrossAxis = std::max(r.x, r.y) * distanceM;
  return 1000.0 * std::sqrt(glm::dot(p, p) / 3.0 * 2.0 + acrossAxis * acrossAxis);
}

QString poseSummary(const Frame& frame) {
  const double mm = poseMillimetresAt(frame, 10.0);
  if (mm < 0) {
    const bool known = frame.poseSource != PoseSource::None;
    return poseSourceName(frame.poseSource) + (known ? QStringLiteral(", accuracy not known") : QString());
  }
  return QStringLiteral("%1, %2 mm at 10 m")
      .arg(poseSourceName(frame.poseSource))
      .arg(mm, 0, 'f', mm < 9.95 ? 1 : 0);
}

QString text(const std::string& utf8) {
  return QString::fromStdString(utf8);
}

QString errorText(const Error& error) {
  return QString::fromStdString(error.text());
}

}  // namespace alidade
