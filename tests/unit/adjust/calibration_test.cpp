// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Boards projected through known lenses: the truth is what they were projected with.

#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "adjust/calibration.h"
#include "adjust/calibration_start.h"
#include "adjust/lens_derivatives.h"

namespace alidade {
namespace {

using testing::Contains;
using testing::HasSubstr;

const Board kBoard{BoardKind::Chessboard, 9, 6, 0.03, 0, {}};

struct Shots {
  int width = 1600, height = 1200;
  std::vector<BoardPicture> pictures;
};

/// A board at `pose`, corners inside the picture only, with noise.
void shoot(const Intrinsics& lens, const RigidTransform& pose, double noisePx, std::mt19937& random, Shots& shots,
           const std::vector<glm::dvec3>& corners) {
  const Camera camera(lens);
  std::normal_distribution<double> noise(0, 1);
  BoardPicture& picture = shots.pictures.emplace_back();
  picture.name = "picture " + std::to_string(shots.pictures.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto pixel = camera.project(pose * corners[i]);
    if (!pixel || !camera.inPicture(*pixel)) continue;
    picture.corners.push_back({static_cast<int>(i), *pixel + noisePx * glm::dvec2(noise(random), noise(random))});
  }
}

/// The board with its middle on the ray of a pixel, `distance` away, turned from parallel to the image.
RigidTransform boardAt(const Intrinsics& lens, const glm::dvec2& pixel, double distance, const glm::dvec3& turn) {
  const double angle = glm::length(turn);
  RigidTransform pose;
  pose.rotation = angle > 0 ? glm::angleAxis(angle, turn / angle) : glm::dquat(1, 0, 0, 0);
  const glm::dvec3 ray = glm::normalize(*Camera(lens).unproject(pixel));
  const std::vector<glm::dvec3> corners = kBoard.corners();
  pose.translation = distance * ray - pose.rotation * (0.5 * (corners.front() + corners.back()));
  return pose;
}

/// Twenty pictures with the board all over, tilted to all sides.
Shots goodShots(const Intrinsics& lens, double noisePx, unsigned seed, const std::vector<glm::dvec3>& corners = kBoard.corners()) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> one(-1, 1);
  Shots shots;
  shots.width = lens.width, shots.height = lens.height;
  for (int i = 0; i < 20; ++i) {
    const glm::dvec2 at(lens.width * (0.12 + 0.76 * (i % 5) / 4.0), lens.height * (0.12 + 0.76 * (i / 5) / 3.0));
    shoot(lens, boardAt(lens, at, 0.35 + 0.1 * one(random), {0.6 * one(random), 0.6 * one(random), 0.5 * one(random)}), noisePx,
          random, shots, corners);
  }
  return shots;
}

Intrinsics lensOf(CameraModel model, const std::vector<double>& parameters) {
  return Intrinsics::fromParameters(model, 1600, 1200, parameters).value();
}

CalibrationSummary calibrated(const Shots& shots, const CalibrationOptions& options) {
  auto made = calibrateCamera(kBoard, shots.width, shots.height, shots.pictures, options);
  EXPECT_TRUE(made) << made.error().text();
  return made ? *made : CalibrationSummary{};
}

/// Largest distance between where two lenses draw the directions that the first one's picture sees.
double largestDifference(const Intrinsics& truth, const Intrinsics& found) {
  const Camera a(truth), b(found);
  double worst = 0;
  for (int y = 100; y <= 1100; y += 50)
    for (int x = 100; x <= 1500; x += 50) {
      const auto ray = a.unproject({x, y});
      if (!ray) continue;
      worst = std::max(worst, glm::length(b.projectUnchecked(*ray) - glm::dvec2(x, y)));
    }
  return worst;
}

const std::vector<Intrinsics>& lenses() {
  static const std::vector<Intrinsics> all{
      lensOf(CameraModel::SimplePinhole, {1150, 812, 590}),
      lensOf(CameraModel::Pinhole, {1150, 1160, 812, 590}),
      lensOf(CameraModel::SimpleRadial, {1150, 812, 590, -0.1}),
      lensOf(CameraModel::Radial, {1150, 812, 590, -0.2, 0.06}),
      lensOf(CameraModel::OpenCv4, {1150, 1160, 812, 590, -0.2, 0.06, 5e-4, -7e-4}),
      lensOf(CameraModel::OpenCv5, {1150, 1160, 812, 590, -0.2, 0.06, 5e-4, -7e-4, -0.01}),
      lensOf(CameraModel::OpenCv8, {1150, 1160, 812, 590, 0.3, -0.1, 5e-4, -7e-4, 0.02, 0.5, -0.05, 0.03}),
      lensOf(CameraModel::OpenCv12, {1150, 1160, 812, 590, 0.3, -0.1, 5e-4, -7e-4, 0.02, 0.5, -0.05, 0.03, 2e-3, -1e-3, 1e-3, 3e-3}),
      lensOf(CameraModel::OpenCv14, {1150, 1160, 812, 590, 0.3, -0.1, 5e-4, -7e-4, 0.02, 0.5, -0.05, 0.03, 2e-3, -1e-3, 1e-3, 3e-3, 0.02, -0.01}),
      lensOf(CameraModel::OpenCvFisheye, {700, 705, 812, 590, -0.02, 0.01, -0.004, 0.0005}),
      lensOf(CameraModel::BrownSkewed, {1150, 1160, 812, 590, -0.2, 0.06, -0.01, 0.002, 5e-3, -7e-3, 0.3, -0.1, 3e-4}),
  };
  return all;
}

TEST(VaryingCamera, ItsDerivativesAreThoseOfDifferencesForEveryModel) {
  std::vector<Intrinsics> all = lenses();
  all.push_back(lensOf(CameraModel::BrownHighOrder, {1150, 1160, 812, 590, 0.3, -0.1, 0.02, -0.01, 0.004, -0.001, 0.4, -0.05, 0.03,
                                                     5e-4, -7e-4, 0.3, -0.1, 0.05, 0.02, 2e-3, -1e-3}));
  const glm::dvec3 p(0.31, -0.22, 0.9);
  for (const Intrinsics& lens : all) {
    const VaryingCamera camera(lens);
    VaryingCamera::Projection at;
    camera.project(p, true, at);
    std::vector<double> step(camera.parameterCount(), 0.0);
    for (int i = 0; i < camera.parameterCount(); ++i) {
      const double h = 1e-6 * std::max(1.0, std::abs(lens.parameters()[i]));
      step[i] = h;
      const glm::dvec2 after = camera.moved(step.data()).project(p);
      step[i] = -h;
      const glm::dvec2 before = camera.moved(step.data()).project(p);
      step[i] = 0;
      const glm::dvec2 difference = (after - before) / (2 * h);
      EXPECT_LT(glm::length(at.byParameter[i] - difference), 1e-5 * (1 + glm::length(difference)))
          << cameraModelName(lens.model) << ' ' << parameterNames(lens.model)[i];
    }
    for (int k = 0; k < 3; ++k) {
      glm::dvec3 shift(0);
      shift[k] = 1e-6;
      const glm::dvec2 difference = (camera.project(p + shift) - camera.project(p - shift)) / 2e-6;
      EXPECT_LT(glm::length(glm::dvec2(at.du[k], at.dv[k]) - difference), 1e-4) << cameraModelName(lens.model);
    }
  }
}

TEST(Calibration, FindsEveryLensAgainFromPerfectCorners) {
  for (const Intrinsics& truth : lenses()) {
    CalibrationOptions options;
    options.model = truth.model, options.parts = 0;
    const CalibrationSummary found = calibrated(goodShots(truth, 0, 1), options);
    ASSERT_TRUE(found.converged) << cameraModelName(truth.model) << ": " << found.reason;
    EXPECT_LT(found.rmsPx, 2e-3) << cameraModelName(truth.model);
    EXPECT_LT(largestDifference(truth, found.intrinsics), 0.03) << cameraModelName(truth.model);
  }
}

/// More coefficients than a lens can fill: what the pictures do not tell apart is held, and it is said.
TEST(Calibration, TheHighOrderBrownFormDrawsWhatThePicturesShow) {
  const Intrinsics truth = lenses()[5];
  CalibrationOptions options;
  options.model = CameraModel::BrownHighOrder, options.parts = 0;
  const CalibrationSummary found = calibrated(goodShots(truth, 0.1, 3), options);
  ASSERT_TRUE(found.converged) << found.reason;
  EXPECT_NEAR(found.sigmaPx, 0.1, 0.01);
  EXPECT_LT(largestDifference(truth, found.intrinsics), 0.5);
}

TEST(Calibration, AFisheyeOf160DegreesIsFoundFromNothing) {
  const Intrinsics truth = lensOf(CameraModel::OpenCvFisheye, {480, 480, 800, 600, -0.01, 0.003, -0.001, 0.0001});
  CalibrationOptions options;
  options.model = CameraModel::OpenCvFisheye;
  const CalibrationSummary found = calibrated(goodShots(truth, 0.1, 3), options);
  ASSERT_TRUE(found.converged) << found.reason;
  EXPECT_NEAR(found.intrinsics.fx, 480, 1);
  EXPECT_LT(largestDifference(truth, found.intrinsics), 1);
}

/// Normalised squared errors of the focal lengths and the principal point follow their own covariance.
TEST(Calibration, StandardDeviationsTellTheErrors) {
  const Intrinsics truth = lenses()[5];
  CalibrationOptions options;
  options.parts = 0;
  double squares = 0, sigmas = 0;
  const int trials = 20;
  for (int t = 0; t < trials; ++t) {
    const CalibrationSummary found = calibrated(goodShots(truth, 0.2, 100 + t), options);
    ASSERT_TRUE(found.converged) << found.reason;
    const auto a = truth.parameters(), b = found.intrinsics.parameters();
    for (int i = 0; i < 4; ++i) squares += std::pow((b[i] - a[i]) / found.parameterStd[i], 2) / (4 * trials);
    sigmas += found.sigmaPx / trials;
  }
  // 20 trials of a few independent numbers each.
  EXPECT_GT(squares, 0.6);
  EXPECT_LT(squares, 1.5);
  EXPECT_NEAR(sigmas, 0.2, 0.005);
}

TEST(Calibration, PicturesLeftOutFitAlmostAsWellWhereThereAreManyOfThem) {
  const CalibrationSummary found = calibrated(goodShots(lenses()[5], 0.2, 7), {});
  ASSERT_TRUE(found.converged) << found.reason;
  ASSERT_TRUE(found.heldOutRmsPx);
  EXPECT_GT(*found.heldOutRmsPx, found.rmsPx);
  EXPECT_LT(*found.heldOutRmsPx, 1.15 * found.rmsPx);
  for (const CalibratedPicture& picture : found.pictures) EXPECT_TRUE(picture.heldOutRmsPx) << picture.name;
}

TEST(Calibration, WrongCornersTakeNoPart) {
  Shots shots = goodShots(lenses()[5], 0.1, 11);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> by(4, 30);
  for (std::size_t i = 0; i < shots.pictures.size(); i += 2) shots.pictures[i].corners[i].pixel += glm::dvec2(by(random), -by(random));
  const CalibrationSummary found = calibrated(shots, {});
  ASSERT_TRUE(found.converged) << found.reason;
  EXPECT_EQ(found.outliers, 10);
  EXPECT_NEAR(found.intrinsics.fx, 1150, 1);
  EXPECT_LT(found.rmsPx, 0.16);
}

TEST(Calibration, ABentBoardShowsItsShape) {
  std::vector<glm::dvec3> bent = kBoard.corners();
  double squares = 0;
  for (glm::dvec3& p : bent) {
    p.z = 0.0006 * std::sin(14.0 * p.x);
    squares += p.z * p.z;
  }
  const Shots shots = goodShots(lenses()[3], 0.05, 21, bent);
  CalibrationOptions options;
  options.model = CameraModel::Radial, options.robust = false;
  const CalibrationSummary flat = calibrated(shots, options);
  options.boardSigmaM = 0.0005;
  const CalibrationSummary adjusted = calibrated(shots, options);
  ASSERT_TRUE(flat.converged && adjusted.converged) << flat.reason << adjusted.reason;
  EXPECT_GT(flat.rmsPx, 3 * adjusted.rmsPx);
  ASSERT_TRUE(adjusted.board);
  // What a tilt and a shift of the board take up is none of its shape.
  const double rms = std::sqrt(squares / static_cast<double>(bent.size()));
  EXPECT_NEAR(adjusted.board->offPlaneM, rms, 0.5 * rms);
  EXPECT_NEAR(adjusted.intrinsics.fx, 1150, 1.5);
}

TEST(Calibration, SetsThatDoNotFixTheCameraAreRefusedWithTheReason) {
  const Intrinsics lens = lenses()[3];
  CalibrationOptions options;
  options.model = CameraModel::Radial;
  std::mt19937 random(1);
  const auto reason = [&](const Shots& shots) {
    const CalibrationSummary made = calibrated(shots, options);
    EXPECT_FALSE(made.converged);
    return made.reason;
  };
  Shots two = goodShots(lens, 0.1, 1);
  two.pictures.resize(2);
  EXPECT_THAT(reason(two), HasSubstr("2 pictures show the board, at least 3 are needed"));

  Shots frontal, tilted, same, middle;
  for (int i = 0; i < 12; ++i) {
    const glm::dvec2 at(300 + 90 * i, 250 + 60 * i);
    shoot(lens, boardAt(lens, at, 0.3 + 0.02 * i, {0, 0, 0.2 * i}), 0.1, random, frontal, kBoard.corners());
    shoot(lens, boardAt(lens, at, 0.3 + 0.02 * i, {0.5, 0.1, 0}), 0.1, random, tilted, kBoard.corners());
    shoot(lens, boardAt(lens, {1100, 500}, 0.4, {0.5, 0.1, 0}), 0.1, random, same, kBoard.corners());
    shoot(lens, boardAt(lens, {800, 600}, 1.2, {0.1 * i - 0.6, 0.4 - 0.06 * i, 0}), 0.1, random, middle, kBoard.corners());
  }
  EXPECT_THAT(reason(frontal), HasSubstr("parallel to the image in all pictures"));
  EXPECT_THAT(reason(tilted), HasSubstr("same attitude in all pictures"));
  EXPECT_THAT(reason(same), HasSubstr("same pose in all pictures"));
  EXPECT_THAT(reason(middle), HasSubstr("never leaves the middle"));
}

TEST(Calibration, NearlyFrontalBoardsAreSaidToBeWeak) {
  const Intrinsics lens = lenses()[3];
  std::mt19937 random(1);
  Shots shots;
  for (int i = 0; i < 12; ++i)
    shoot(lens, boardAt(lens, {200 + 100 * i, 150 + 75 * (i % 12)}, 0.3 + 0.02 * i, {0.1 * std::cos(i), 0.1 * std::sin(i), 0.2 * i}), 0.1,
          random, shots, kBoard.corners());
  CalibrationOptions options;
  options.model = CameraModel::Radial, options.parts = 0;
  const CalibrationSummary made = calibrated(shots, options);
  ASSERT_TRUE(made.converged) << made.reason;
  EXPECT_THAT(made.warnings, Contains(HasSubstr("is tilted by")));
  EXPECT_THAT(made.correlations, Contains(HasSubstr("f and the camera's distance")));
}

TEST(Calibration, SenselessInputIsAnError) {
  Shots shots = goodShots(lenses()[5], 0.1, 1);
  shots.pictures[0].corners[0].pixel.x = std::nan("");
  EXPECT_THAT(calibrateCamera(kBoard, 1600, 1200, shots.pictures).error().what, HasSubstr("not finite"));
  shots.pictures[0].corners[0] = {99, {10, 10}};
  EXPECT_THAT(calibrateCamera(kBoard, 1600, 1200, shots.pictures).error().what, HasSubstr("54 corners, number 99"));
  CalibrationOptions options;
  options.boardSigmaM = -1;
  EXPECT_FALSE(calibrateCamera(kBoard, 1600, 1200, {}, options));
}

TEST(CalibrationStart, AHomographyGivesBackItsPoseAndItsFocalLength) {
  const RigidTransform truth = boardAt(lensOf(CameraModel::SimplePinhole, {900, 799.5, 599.5}), {900, 500}, 0.6, {0.4, -0.3, 0.2});
  std::vector<glm::dvec2> plane, image, pixel;
  for (const glm::dvec3& p : kBoard.corners()) {
    const glm::dvec3 q = truth * p;
    plane.emplace_back(p), image.emplace_back(q.x / q.z, q.y / q.z), pixel.push_back(900.0 * image.back());
  }
  const auto h = homographyOf(plane, image);
  ASSERT_TRUE(h);
  const auto pose = poseOfHomography(*h, plane[0]);
  ASSERT_TRUE(pose);
  EXPECT_LT(rotationAngleBetween(*pose, truth), 1e-9);
  EXPECT_LT(glm::length(pose->translation - truth.translation), 1e-9);
  const auto focal = focalOfHomographies({*homographyOf(plane, pixel)});
  ASSERT_TRUE(focal);
  EXPECT_NEAR(*focal, 900, 1e-5);
  EXPECT_FALSE(homographyOf({plane.begin(), plane.begin() + 9}, {image.begin(), image.begin() + 9})) << "a row of corners";
}

}  // namespace
}  // namespace alidade
