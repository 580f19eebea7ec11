// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "plugin_api/import_slip.h"
#include "plugin_api/reader.h"

namespace alidade {

/// Poses by time on their way into a CameraSet: the checks that every trajectory format shares.
class TrajectoryBuilder {
 public:
  /// worldFromCamera; quaternion x y z w. Error where it is not finite, farther than 1e9 m, or no rotation.
  Result<void> add(double timeSecs, const glm::dvec3& position, const glm::dvec4& xyzw, const std::string& place);
  /// Sorted by time, with the slips as warnings. Error where there is no pose.
  Result<CameraSet> take(const std::string& formatName, const std::string& path);

 private:
  CameraSet m_set;
  ImportSlip m_unsorted, m_unnormalised, m_twice;
};

}  // namespace alidade
