// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>

#include <QString>
#include <QStringList>

#include <glm/glm.hpp>

#include "base/error.h"
#include "survey/project.h"

namespace alidade {

// How figures are written on screen: the unit beside every number, thousands parted by a narrow
// space, a true minus sign.

constexpr QChar kMinus(0x2212);
QString withMinus(QString number);  ///< each hyphen a minus
/// A report of a job: the hyphens before its figures as minus signs, those within names and words as they are.
QString reportText(const std::string& utf8);
QString formatNumber(double value, int decimals);  ///< "−0.25", never "-0.00"; "–" where not finite
QString formatCoordinate(double metres);       ///< "100 612.314"
QString formatWorld(const glm::dvec3& world);  ///< "E 100 612.314  N 196 261.882  H 6.913 m"
QString formatPixel(const glm::dvec2& pixel);  ///< "812.4, 377.0 px"
QString formatCount(std::uint64_t count);      ///< "8.1 M", "12 k", "317"
QString formatPointsOf(std::uint64_t drawn, std::uint64_t total);  ///< "8.1 of 100 M points"
QString formatMillimetres(double metres);                          ///< "12 mm", "1.20 m" from a metre on
QString formatDistance(double metres);                             ///< "14.82 m"
QString formatSeconds(double secs);                                ///< "14.27 s"
QString formatPercent(double fraction);                            ///< "62 %"
QString poseSourceName(PoseSource source);                         ///< "no pose", "from file" …

/// Millimetres at `distanceM` that the frame's pose is good for (one sigma); below 0 where unknown.
double poseMillimetresAt(const Frame& frame, double distanceM);
/// "Refined, 3 mm at 10 m"
QString poseSummary(const Frame& frame);

QString text(const std::string& utf8);
QString errorText(const Error& error);

}  // namespace alidade
