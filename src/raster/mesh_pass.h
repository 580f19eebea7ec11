// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <vector>

#include "base/image.h"
#include "camera/camera.h"
#include "geometry/rigid_transform.h"
#include "raster/occluder_mesh.h"

namespace alidade {

/// Inverse depth, 1/metres, of the meshes' nearest surface a pixel, 0 where none is. Drawn through the full
/// lens: quads larger than 32 px on screen in parts, so that a straight edge of a part cannot sag off the
/// bent one; what reaches behind the camera is cut, what the lens does not see is left out. A pixel that was
/// missed is filled where at least six of its eight neighbours agree.
Image<float> drawMeshes(const std::vector<std::shared_ptr<const OccluderMesh>>& meshes, const Camera& camera,
                        const RigidTransform& cameraFromWorld);

}  // namespace alidade
