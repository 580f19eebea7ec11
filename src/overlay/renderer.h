// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <string>

#include "base/error.h"
#include "overlay/device.h"
#include "overlay/frame_description.h"

namespace alidade {

/// The video overlay: a frame description in, a picture out, needing no window. Passes in order:
/// camera image, point depth, design, point colour, then stake points, annotations and selection.
/// One user at a time; make one a thread.
class OverlayRenderer {
 public:
  /// Error where no device can be made.
  static Result<std::unique_ptr<OverlayRenderer>> create();
  explicit OverlayRenderer(std::unique_ptr<OverlayDevice> device);
  ~OverlayRenderer();

  Result<OverlayPicture> render(const FrameDescription& frame);
  std::string deviceName() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace alidade
