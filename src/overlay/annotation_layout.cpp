// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/annotation_layout.h"

#include <algorithm>
#include <cmath>

#include <QFontMetricsF>
#include <QGuiApplication>

#include "overlay/frame_uniform.h"

namespace alidade {

namespace {

constexpr int kLongestLine = 42;    // characters
constexpr int kLongestText = 2000;  // characters; more cannot be read on a picture
constexpr int kMostLines = 12;

}  // namespace

double resultPerRaw(const FrameDescription& frame, const Camera& scaledCamera) {
  return frame.camera.width() > 0 ? static_cast<double>(scaledCamera.width()) / frame.camera.width() : 1.0;
}

glm::dvec2 resultFromRaw(const FrameDescription& frame, const Camera& scaledCamera, const glm::dvec2& rawPx) {
  const glm::dvec2 raw(std::max(frame.camera.width(), 1), std::max(frame.camera.height(), 1));
  const glm::dvec2 result(scaledCamera.width(), scaledCamera.height());
  return (rawPx + 0.5) * result / raw - 0.5;
}

bool hasFonts() {
  return qobject_cast<QGuiApplication*>(QCoreApplication::instance()) != nullptr;
}

QFont overlayFont(double scale, bool bold) {
  QFont font(QStringLiteral("DejaVu Sans"));
  font.setPixelSize(std::max(6, static_cast<int>(std::lround(14 * scale))));
  font.setBold(bold);
  return font;
}

TextBlock layOutText(const std::string& text, const QFont& font) {
  TextBlock block;
  const QString whole = QString::fromStdString(text).left(kLongestText);
  for (const QString& paragraph : whole.split(QLatin1Char('\n'))) {
    QString line;
    for (const QString& word : paragraph.split(QLatin1Char(' '), Qt::SkipEmptyParts)) {
      if (!line.isEmpty() && line.size() + word.size() >= kLongestLine) {
        block.lines << line;
        line.clear();
      }
      line += (line.isEmpty() ? QString() : QStringLiteral(" ")) + word.left(kLongestLine);
    }
    if (!line.isEmpty()) block.lines << line;
  }
  if (block.lines.size() > kMostLines) {
    block.lines.erase(block.lines.begin() + kMostLines, block.lines.end());
    block.lines.back() += QStringLiteral(" …");
  }
  if (block.lines.isEmpty()) return block;
  double width = 0, lineHeight = font.pixelSize() * 1.25;
  if (hasFonts()) {
    const QFontMetricsF metrics(font);
    lineHeight = metrics.height();
    for (const QString& line : block.lines) width = std::max(width, metrics.horizontalAdvance(line));
  }
  block.padding = 0.35 * font.pixelSize();
  block.size = QSizeF(width + 2 * block.padding, lineHeight * block.lines.size() + 2 * block.padding);
  return block;
}

std::optional<AnnotationLayout> layOutAnnotation(const Annotation& annotation, const FrameDescription& frame,
                                                 const Camera& scaledCamera) {
  AnnotationLayout layout;
  if (annotation.anchor == AnnotationAnchor::World) {
    const auto pInCamera = pointAtItsRow(scaledCamera, frame.shutter, frame.cameraFromWorld * annotation.world);
    const auto pixel = pInCamera ? scaledCamera.project(*pInCamera) : std::nullopt;
    if (!pixel) return std::nullopt;
    layout.tip = *pixel;
    layout.depth = pInCamera->z;
  } else {
    layout.tip = resultFromRaw(frame, scaledCamera, annotation.pixel);
  }
  layout.tail = layout.tip + annotation.offsetPx * resultPerRaw(frame, scaledCamera);
  const glm::dvec2 reach(2.0 * scaledCamera.width(), 2.0 * scaledCamera.height());
  if (!glm::all(glm::lessThan(glm::abs(layout.tip), reach)) ||
      !glm::all(glm::lessThan(glm::abs(layout.tail), reach)))
    return std::nullopt;
  const double scale = drawingScale(scaledCamera.width(), scaledCamera.height(), frame.enlargement);
  layout.text = layOutText(annotation.text, overlayFont(scale));
  if (layout.text.lines.isEmpty()) return layout;
  // The text stands on the side away from the tip, so that the leader does not cross it.
  const double x = layout.tail.x >= layout.tip.x ? layout.tail.x : layout.tail.x - layout.text.size.width();
  layout.box = QRectF(QPointF(x, layout.tail.y - 0.5 * layout.text.size.height()), layout.text.size);
  return layout;
}

}  // namespace alidade
