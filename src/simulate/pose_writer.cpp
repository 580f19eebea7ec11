// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/pose_writer.h"

#include <fmt/format.h>

#include "simulate/camera_path.h"
#include "simulate/output_file.h"

namespace alidade {

std::string frameFileName(int frame) {
  return fmt::format("frame_{:04}.png", frame);
}

Result<void> writeColmapModel(const std::string& folder, const Intrinsics& in,
                              const std::vector<RigidTransform>& cameraFromWorld) {
  if (auto made = makeFolder(folder); !made) return made;
  const auto& d = in.distortion;
  std::string cameras =
      "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  cameras += fmt::format("1 FULL_OPENCV {} {} {} {} {} {} {} {} {} {} {} {} {} {}\n", in.width, in.height,
                         in.fx, in.fy, in.cx + 0.5, in.cy + 0.5, d.k[0], d.k[1], d.p1, d.p2, d.k[2], d.q[0],
                         d.q[1], d.q[2]);
  std::string images =
      "# Image list with two lines of data per image:\n"
      "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
      "#   POINTS2D[] as (X, Y, POINT3D_ID)\n";
  for (std::size_t i = 0; i < cameraFromWorld.size(); ++i) {
    const auto& q = cameraFromWorld[i].rotation;
    const auto& t = cameraFromWorld[i].translation;
    images += fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.10f} {:.10f} {:.10f} 1 {}\n\n", i + 1, q.w,
                          q.x, q.y, q.z, t.x, t.y, t.z, frameFileName(static_cast<int>(i)));
  }
  if (auto written = writeWholeFile(folder + "/cameras.txt", cameras); !written) return written;
  if (auto written = writeWholeFile(folder + "/images.txt", images); !written) return written;
  return writeWholeFile(folder + "/points3D.txt", "# 3D point list with one line of data per point:\n");
}

Result<void> writeTrajectory(const std::string& path, const std::vector<RigidTransform>& cameraFromWorld,
                             double posesPerSecond, double startSecs) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (std::size_t i = 0; i < cameraFromWorld.size(); ++i) {
    const RigidTransform pose = cameraFromWorld[i].inverse();
    const auto& q = pose.rotation;
    const auto& t = pose.translation;
    text += fmt::format("{:.9f} {:.10f} {:.10f} {:.10f} {:.17g} {:.17g} {:.17g} {:.17g}\n",
                        startSecs + static_cast<double>(i) / posesPerSecond, t.x, t.y, t.z, q.x, q.y, q.z, q.w);
  }
  return writeWholeFile(path, text);
}

Result<void> writeCalibration(const std::string& path, const Intrinsics& in) {
  const auto matrix = [](const char* name, int rows, int columns, const std::string& data) {
    return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n", name, rows, columns, data);
  };
  const auto& d = in.distortion;
  return writeWholeFile(path, "%YAML:1.0\n---\n" + fmt::format("image_width: {}\nimage_height: {}\n", in.width, in.height) +
                                  matrix("camera_matrix", 3, 3, fmt::format("{}, 0., {}, 0., {}, {}, 0., 0., 1.", in.fx, in.cx, in.fy, in.cy)) +
                                  matrix("distortion_coefficients", 1, 5, fmt::format("{}, {}, {}, {}, {}", d.k[0], d.k[1], d.p1, d.p2, d.k[2])));
}

}  // namespace alidade
