// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "image/image_compare.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <QImage>

namespace alidade {

namespace {

QImage wrapped(const ColourImage& picture) {
  return QImage(reinterpret_cast<const uchar*>(picture.data()), picture.width(), picture.height(),
                4 * picture.width(), QImage::Format_RGBA8888);
}

QString pathIn(const char* folder, const std::string& name) {
  std::filesystem::create_directories(folder);
  return QString::fromStdString(std::string(folder) + "/" + name + ".png");
}

}  // namespace

ImageComparison compareToBaseline(const ColourImage& picture, const std::string& name,
                                  const ImageTolerance& tolerance) {
  ImageComparison result;
  if (const char* update = std::getenv("ALIDADE_UPDATE_BASELINES"); update && *update == '1') {
    result.same =
        wrapped(picture).convertToFormat(QImage::Format_RGB888).save(pathIn(ALIDADE_BASELINE_DIR, name));
    result.report = "baseline written";
    return result;
  }
  const QImage baseline = QImage(pathIn(ALIDADE_BASELINE_DIR, name)).convertToFormat(QImage::Format_RGBA8888);
  if (baseline.width() != picture.width() || baseline.height() != picture.height()) {
    result.differing = 1;
    result.report = baseline.isNull() ? "there is no baseline " + name : "the baseline has another size";
    return result;
  }
  QImage difference(picture.width(), picture.height(), QImage::Format_RGBA8888);
  std::size_t count = 0;
  for (int y = 0; y < picture.height(); ++y) {
    const uchar* expected = baseline.constScanLine(y);
    const auto* got = reinterpret_cast<const uchar*>(picture.row(y));
    uchar* mark = difference.scanLine(y);
    for (int x = 0; x < picture.width(); ++x) {
      int largest = 0;
      for (int k = 0; k < 3; ++k) {
        const int d = std::abs(expected[4 * x + k] - got[4 * x + k]);
        mark[4 * x + k] = static_cast<uchar>(std::min(255, 4 * d));
        largest = std::max(largest, d);
      }
      mark[4 * x + 3] = 255;
      count += largest > tolerance.perChannel;
    }
  }
  result.differing = static_cast<double>(count) / static_cast<double>(picture.size());
  result.same = result.differing <= tolerance.fraction;
  if (result.same) return result;
  wrapped(picture).save(pathIn(ALIDADE_IMAGE_DIFF_DIR, name));
  difference.save(pathIn(ALIDADE_IMAGE_DIFF_DIR, name + "-difference"));
  result.report = std::to_string(count) + " pixels differ; see " + ALIDADE_IMAGE_DIFF_DIR + "/" + name +
                  "-difference.png";
  return result;
}

}  // namespace alidade
