// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "base/id.h"

namespace alidade {

using ScanId = Id<struct ScanTag>;
using CameraId = Id<struct CameraTag>;
using FrameId = Id<struct FrameTag>;
using VideoId = Id<struct VideoTag>;
using TrajectoryId = Id<struct TrajectoryTag>;
using DesignId = Id<struct DesignTag>;
using AnnotationId = Id<struct AnnotationTag>;
using ObservationId = Id<struct ObservationTag>;
using FindingId = Id<struct FindingTag>;

}  // namespace alidade
