// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/image.h"
#include "camera/distortion.h"
#include "camera/lens_domain.h"
#include "camera/lens_kernel.h"

namespace alidade {

/// The models that files name. All but the fisheye are subsets of one Distortion.
enum class CameraModel {
  SimplePinhole,   ///< COLMAP SIMPLE_PINHOLE: f cx cy
  Pinhole,         ///< COLMAP PINHOLE: fx fy cx cy
  SimpleRadial,    ///< COLMAP SIMPLE_RADIAL: f cx cy k1
  Radial,          ///< COLMAP RADIAL: f cx cy k1 k2
  OpenCv4,         ///< COLMAP OPENCV: fx fy cx cy k1 k2 p1 p2
  OpenCv5,         ///< fx fy cx cy k1 k2 p1 p2 k3
  OpenCv8,         ///< COLMAP FULL_OPENCV: fx fy cx cy k1 k2 p1 p2 k3 q1 q2 q3
  OpenCv12,        ///< … s1 s2 s3 s4
  OpenCv14,        ///< … tauX tauY
  OpenCvFisheye,   ///< COLMAP OPENCV_FISHEYE: fx fy cx cy k1 k2 k3 k4
  BrownHighOrder,  ///< fx fy cx cy k1..k6 q1..q3 p1 p2 t3..t6 shear skew
  BrownSkewed,     ///< fx fy cx cy k1..k4 p1 p2 t3 t4 imageSkew: Metashape's frame camera
};

/// "OPENCV", "FULL_OPENCV" …: COLMAP's name where it has one, else ours ("OPENCV5", "OPENCV12",
/// "OPENCV14", "BROWN_HIGH_ORDER", "BROWN_SKEWED"). parseCameraModel takes what cameraModelName gives.
std::string_view cameraModelName(CameraModel model);
std::optional<CameraModel> parseCameraModel(std::string_view name);

/// Number of parameters that the model writes, in the order of the comments above.
int parameterCount(CameraModel model);
/// What they are called: "fx", "cy", "k1", "q2" … (see Distortion); "f" where the model has one focal length.
std::vector<std::string> parameterNames(CameraModel model);

/// What a calibration gives. Pixels in OpenCV's origin: (0,0) is the *centre* of the top-left pixel.
struct Intrinsics {
  CameraModel model = CameraModel::Pinhole;
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;
  Distortion distortion;

  /// Flat parameters in the model's own order (see CameraModel).
  std::vector<double> parameters() const;
  static Result<Intrinsics> fromParameters(CameraModel model, int width, int height,
                                           const std::vector<double>& parameters);
  /// A sentence for each thing that cannot be: size, focal length, non-finite numbers.
  Result<void> validate() const;
};

/// d(pixel)/d(pInCamera), pixel = (u, v): two rows of three.
struct ProjectionJacobian {
  glm::dvec3 du;
  glm::dvec3 dv;
};

/// A calibrated camera: projection through the full lens, its inverse, and the domain where the
/// lens model holds. Camera axes are OpenCV's: x right, y down, z forward; metres. Immutable and
/// thread-safe once made.
class Camera {
 public:
  Camera() = default;
  explicit Camera(const Intrinsics& intrinsics);

  const Intrinsics& intrinsics() const { return m_intrinsics; }
  int width() const { return m_intrinsics.width; }
  int height() const { return m_intrinsics.height; }

  /// The model folds back where d(r·radial)/dr reaches 0: this is the last good r = |(X,Y)|/Z of the
  /// undistorted image plane (for a fisheye, the last good tan(theta), possibly infinite).
  double foldBackRadius() const { return m_foldBackRadius; }

  /// The largest undistorted radius that any pixel of the picture sees, at most foldBackRadius().
  double imageRadius() const { return m_imageRadius; }

  /// Pixel of a point, through the lens; nothing for Z <= 0 or beyond the fold-back radius. The
  /// pixel may lie outside the picture: see inPicture().
  std::optional<glm::dvec2> project(const glm::dvec3& pInCamera) const;
  std::optional<glm::dvec2> project(const glm::dvec3& pInCamera, ProjectionJacobian& jacobian) const;

  /// The same without the domain checks: extrapolates smoothly for solvers. Z must not be 0.
  glm::dvec2 projectUnchecked(const glm::dvec3& pInCamera) const;

  /// Direction (x, y, 1) that the pixel sees; nothing where the model has no inverse.
  /// unproject(project(p)) agrees within 1e-6 px over the model's domain.
  std::optional<glm::dvec3> unproject(const glm::dvec2& pixel) const;

  /// The picture covers [-0.5, width-0.5) × [-0.5, height-0.5).
  bool inPicture(const glm::dvec2& pixel) const;

  /// True where a direction (x, y, 1) lies in the undistortion mask: inside the fold-back radius and
  /// seen by a pixel of the picture.
  bool sees(double x, double y) const;

  /// The undistortion mask of Gantner (2018): the undistorted image plane sampled at the pixel grid of
  /// the pinhole (fx, fy, cx, cy) grown to cover the picture; 255 where the raw picture has a pixel.
  Image<unsigned char> undistortionMask(int width, int height) const;

  /// The pinhole of undistortionMask(width, height): this camera's, scaled to that size, with focal
  /// lengths shortened until everything that the picture sees within 80 degrees of the axis fits.
  Intrinsics maskPinhole(int width, int height) const;

  /// The same lens on a picture of another size (0.5 px origins handled): "--size", thumbnails.
  Camera scaledTo(int width, int height) const;

  /// The lens for `distort` of lens_kernel.h, and the domain where it maps one to one.
  const Lens<double>& lens() const { return m_domain.lens(); }
  const LensDomain& domain() const { return m_domain; }

 private:
  glm::dvec2 normalized(const glm::dvec2& pixel) const {
    return {(pixel.x - m_intrinsics.cx) / m_intrinsics.fx, (pixel.y - m_intrinsics.cy) / m_intrinsics.fy};
  }
  glm::dvec2 pixelOf(const glm::dvec2& distorted) const {
    return {m_intrinsics.fx * distorted.x + m_intrinsics.cx, m_intrinsics.fy * distorted.y + m_intrinsics.cy};
  }
  double farthestSeenTowards(const glm::dvec2& pixel) const;

  Intrinsics m_intrinsics;
  LensDomain m_domain;
  double m_foldBackRadius = 0;
  double m_imageRadius = 0;
};

}  // namespace alidade
