// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <map>
#include <tuple>

#include <QColor>
#include <QFont>
#include <QImage>

#include "overlay/annotation_layout.h"

namespace alidade {

/// Texts as drawn, with a dark casing, kept from frame to frame: stroking the letters of a dozen labels takes as long as a
/// video's frame can.
class TextSprites {
 public:
  struct Sprite {
    QImage image;
    int margin = 0;  ///< pixels around the block, which the casing reaches into
  };
  /// `scale`: of the casing's width. Valid until the next call.
  const Sprite& of(const TextBlock& block, const QFont& font, const QColor& colour, double scale);

 private:
  using Key = std::tuple<QString, QString, QRgb, double>;
  std::map<Key, Sprite> m_sprites;
};

}  // namespace alidade
