// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "adjust/calibration.h"
#include "base/image.h"

class QPainter;
class QRectF;

namespace alidade {

enum class CalibrationPlot {
  Residuals,  ///< every corner's residual as a line in the picture, enlarged, and their means over cells: what the lens leaves
  Radial,     ///< residuals along the way from the principal point over the distance from it, with the mean of each ring
  Coverage,   ///< how many corners each cell of the picture holds
};

enum class PlotGround { Paper, Dark };

/// Paints into `area`, whatever the device: a picture, a page.
void paintCalibrationPlot(QPainter& painter, const QRectF& area, CalibrationPlot plot, const CalibrationSummary& summary,
                          PlotGround ground);

/// The same as a picture. Needs a QGuiApplication for text.
ColourImage calibrationPicture(CalibrationPlot plot, const CalibrationSummary& summary, int width, int height, PlotGround ground);

}  // namespace alidade
