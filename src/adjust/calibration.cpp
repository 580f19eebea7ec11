// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/calibration.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "adjust/calibration_checks.h"
#include "adjust/calibration_start.h"
#include "adjust/network.h"
#include "adjust/resection.h"

namespace alidade {

namespace {

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double rootMeanSquare(double sum, int count) {
  return count > 0 ? std::sqrt(sum / count) : 0;
}

/// A camera of `model` with what is known of `in` and the rest 0.
Intrinsics asModel(const Intrinsics& in, CameraModel model) {
  Intrinsics made = in;
  made.model = model;
  made.distortion.fisheye = model == CameraModel::OpenCvFisheye;
  return made;
}

/// One calibration: the pictures that carry it, and the network that they make.
class Calibration {
 public:
  Calibration(const Board& board, int width, int height, const CalibrationOptions& options, const Progress& progress)
      : m_board(board), m_corners(board.corners()), m_width(width), m_height(height), m_options(options), m_progress(progress) {}

  Result<CalibrationSummary> run(const std::vector<BoardPicture>& pictures);

 private:
  Network networkOf(const std::vector<int>& pictures, double sigmaPx) const;
  Result<NetworkSummary> adjust(const Network& network, bool robust, const Progress& progress) const;
  Result<std::optional<std::string>> fit();
  Result<std::optional<std::string>> fitHolding(const std::string& letters);
  Result<void> approach();
  void take(const NetworkSummary& adjusted);
  void describe(const NetworkSummary& adjusted);
  void describeBoard(const NetworkSummary& adjusted);
  Result<void> checkHeldOut();
  std::optional<double> heldOutSquares(int picture, const Intrinsics& lens, int& count) const;
  CalibrationSummary refused(std::string reason);

  const Board& m_board;
  const std::vector<glm::dvec3> m_corners;
  const int m_width, m_height;
  const CalibrationOptions& m_options;
  const Progress& m_progress;
  std::vector<BoardPicture> m_pictures;
  std::vector<RigidTransform> m_poses;  ///< one a picture
  Intrinsics m_lens;
  double m_sigmaPx = 1;
  std::string m_heldLetters;  ///< parameters whose names begin so stay 0
  CalibrationSummary m_summary;
};

CalibrationSummary Calibration::refused(std::string reason) {
  CalibrationSummary summary;
  summary.reason = std::move(reason);
  summary.warnings = m_summary.warnings;
  return summary;
}

Network Calibration::networkOf(const std::vector<int>& pictures, double sigmaPx) const {
  Network network;
  NetworkCamera camera;
  camera.name = "camera", camera.intrinsics = m_lens;
  camera.freeFocal = camera.freePrincipalPoint = camera.freeDistortion = true;
  for (const std::string& name : parameterNames(m_lens.model)) camera.held.push_back(m_heldLetters.find(name[0]) != std::string::npos);
  network.cameras.push_back(camera);
  const double boardSigma = m_options.boardSigmaM;
  for (std::size_t i = 0; i < m_corners.size(); ++i) {
    NetworkPoint point;
    point.name = fmt::format("corner {}", i);
    point.kind = PointKind::Control, point.world = m_corners[i], point.sigmaM = glm::dvec3(boardSigma);
    network.points.push_back(std::move(point));
  }
  for (const int i : pictures) {
    const int frame = static_cast<int>(network.frames.size());
    NetworkPose pose;
    pose.name = m_pictures[i].name, pose.bodyFromWorld = m_poses[i];
    network.poses.push_back(std::move(pose));
    NetworkFrame made;
    made.name = m_pictures[i].name, made.pose = frame, made.camera = 0;
    network.frames.push_back(std::move(made));
    for (const BoardCorner& c : m_pictures[i].corners) network.observations.push_back({frame, c.corner, c.pixel, sigmaPx});
  }
  return network;
}

Result<NetworkSummary> Calibration::adjust(const Network& network, bool robust, const Progress& progress) const {
  NetworkOptions options;
  options.maximumIterations = 500;
  if (!robust) options.huberSigmas = 0;
  return adjustNetwork(network, options, progress);
}

/// The models on the way to one with many coefficients: each starts from the one before, where its own coefficients
/// are still 0. Without its denominator one does not come from a model that has it.
std::vector<CameraModel> wayTo(CameraModel model, bool withDenominator) {
  switch (model) {
    case CameraModel::OpenCvFisheye: return {};
    case CameraModel::SimplePinhole:
    case CameraModel::Pinhole: return {CameraModel::SimplePinhole};
    case CameraModel::OpenCv8:
    case CameraModel::BrownSkewed: return {CameraModel::SimpleRadial, CameraModel::OpenCv5};
    case CameraModel::OpenCv12:
    case CameraModel::OpenCv14:
    case CameraModel::BrownHighOrder:
      if (!withDenominator) return {CameraModel::SimpleRadial, CameraModel::OpenCv5};
      return {CameraModel::SimpleRadial, CameraModel::OpenCv5, CameraModel::OpenCv8};
    default: return {CameraModel::SimpleRadial};
  }
}

Result<void> Calibration::approach() {
  std::vector<int> all(m_pictures.size());
  std::iota(all.begin(), all.end(), 0);
  for (const CameraModel model : wayTo(m_options.model, m_heldLetters.find('q') == std::string::npos)) {
    const Intrinsics before = m_lens;
    m_lens = asModel(m_lens, model);
    Network network = networkOf(all, 0.5);
    network.cameras[0].freePrincipalPoint = parameterCount(model) > parameterCount(CameraModel::SimpleRadial);
    for (NetworkPoint& point : network.points) point.sigmaM = glm::dvec3(0);
    const auto step = adjust(network, m_options.robust, m_progress.part(0, 0.15));
    if (!step) return fail(step.error());
    if (step->converged) take(*step);
    else m_lens = before;
  }
  return {};
}

void Calibration::take(const NetworkSummary& adjusted) {
  m_lens = adjusted.cameras[0];
  for (std::size_t i = 0; i < m_poses.size(); ++i) m_poses[i] = adjusted.poses[i].bodyFromWorld;
}

/// Nothing where it converged, else why not. The high-order Brown form has more radial coefficients than a lens can fill: six of a
/// series and three of its denominator draw the same curves in many ways. Where the pictures do not choose, the denominator
/// stays 1, and where there is hardly any decentring, its growth 0.
Result<std::optional<std::string>> Calibration::fit() {
  const Intrinsics lens = m_lens;
  const std::vector<RigidTransform> poses = m_poses;
  auto why = fitHolding("");
  if (m_options.model != CameraModel::BrownHighOrder) return why;
  for (const auto& [letters, names] : {std::pair("q", "q1, q2 and q3"), {"qt", "q1 to q3 and t3 to t6"}}) {
    if (!why || !*why) break;
    m_lens = lens, m_poses = poses, m_summary.iterations = 0;
    why = fitHolding(letters);
    if (why && !*why)
      m_summary.warnings.push_back(fmt::format("{} stayed 0: the pictures do not tell them from the other coefficients", names));
  }
  return why;
}

/// The same with what begins with one of the letters at 0.
Result<std::optional<std::string>> Calibration::fitHolding(const std::string& letters) {
  m_heldLetters = letters;
  if (const auto near = approach(); !near) return fail(near.error());
  m_lens = asModel(m_lens, m_options.model);
  std::vector<int> all(m_pictures.size());
  std::iota(all.begin(), all.end(), 0);
  // First with a guess of how well corners are seen, then with what the residuals say of it, until they say the same.
  m_sigmaPx = 0.5;
  constexpr int most = 8;
  for (int round = 0; round < most; ++round) {
    const auto adjusted = adjust(networkOf(all, m_sigmaPx), m_options.robust, m_progress.part(0.15, 0.6));
    if (!adjusted) return fail(adjusted.error());
    m_summary.iterations += adjusted->iterations;
    if (!adjusted->converged)
      return std::optional(fmt::format("{}. The pictures may not carry the model {}: take one with fewer parameters, or more "
                                       "pictures with the board tilted to all sides", adjusted->reason, cameraModelName(m_options.model)));
    take(*adjusted);
    std::vector<double> sizes;
    for (const NetworkResidual& r : adjusted->residuals)
      if (r.kind == ResidualKind::Control) sizes.push_back(r.sigmas);
    // Of two normal residuals |r|/sigma has the median 1.1774. Perfect corners would leave no sigma to work with.
    const double sigma = std::max(1e-4, m_sigmaPx * medianOf(std::move(sizes)) / 1.1774);
    const bool settled = std::abs(sigma - m_sigmaPx) <= 0.01 * m_sigmaPx;
    if (settled || round + 1 == most) {
      describe(*adjusted);
      break;
    }
    m_sigmaPx = sigma;
  }
  return std::optional<std::string>();
}

void Calibration::describe(const NetworkSummary& adjusted) {
  CalibrationSummary& s = m_summary;
  s.intrinsics = m_lens;
  s.redundancy = adjusted.redundancy;
  s.sigmaPx = m_sigmaPx * adjusted.sigma0;
  const CameraAccuracy& accuracy = adjusted.cameraAccuracy[0];
  const int count = parameterCount(m_lens.model);
  for (int a = 0; a < count; ++a) {
    s.parameterStd.push_back(adjusted.sigma0 / adjusted.sigmaScale * accuracy.std(a));
    for (int b = 0; b < count; ++b) s.correlation.push_back(accuracy.correlation(a, b));
  }
  for (std::size_t i = 0; i < m_pictures.size(); ++i)
    s.pictures.push_back({m_pictures[i].name, m_poses[i], 0, 0, 0, boardTilt(m_poses[i]), {}});
  double sum = 0;
  int fitted = 0;
  std::vector<double> squares(m_pictures.size(), 0);
  std::vector<const NetworkResidual*> seen;  // by the observation, which networkOf made picture by picture
  for (const NetworkResidual& r : adjusted.residuals) {
    if (r.kind != ResidualKind::Control) continue;
    seen.resize(std::max(seen.size(), static_cast<std::size_t>(r.index) + 1));
    seen[r.index] = &r;
  }
  std::size_t at = 0;
  for (std::size_t i = 0; i < m_pictures.size(); ++i)
    for (const BoardCorner& c : m_pictures[i].corners) {
      const NetworkResidual& r = *seen[at++];
      s.residuals.push_back({static_cast<int>(i), c.corner, c.pixel, r.residualPx, r.outlier});
      CalibratedPicture& picture = s.pictures[i];
      ++picture.corners;
      if (r.outlier) {
        ++picture.outliers, ++s.outliers;
        continue;
      }
      const double square = glm::dot(r.residualPx, r.residualPx);
      squares[i] += square, sum += square, ++fitted;
    }
  for (std::size_t i = 0; i < squares.size(); ++i)
    s.pictures[i].rmsPx = rootMeanSquare(squares[i], s.pictures[i].corners - s.pictures[i].outliers);
  s.rmsPx = rootMeanSquare(sum, fitted);
  if (m_options.boardSigmaM > 0) describeBoard(adjusted);
  judgeCalibration(accuracy, s);
}

void Calibration::describeBoard(const NetworkSummary& adjusted) {
  BoardShape shape;
  double off = 0, in = 0;
  for (std::size_t i = 0; i < m_corners.size(); ++i) {
    const glm::dvec3 d = adjusted.points[i] - m_corners[i];
    off += d.z * d.z, in += d.x * d.x + d.y * d.y;
    if (glm::length(d) > shape.worstM) shape.worstM = glm::length(d), shape.worstCorner = static_cast<int>(i);
  }
  const int count = static_cast<int>(m_corners.size());
  shape.offPlaneM = rootMeanSquare(off, count), shape.inPlaneM = rootMeanSquare(in, count);
  m_summary.board = shape;
}

/// Sum of squares of a picture's corners with a lens made without it, its pose alone fitted; nothing where that fails.
std::optional<double> Calibration::heldOutSquares(int picture, const Intrinsics& lens, int& count) const {
  std::vector<ResectionObservation> seen;
  for (const CalibrationResidual& r : m_summary.residuals)
    if (r.picture == picture && !r.outlier) seen.push_back({r.pixel, m_corners[r.corner], m_sigmaPx, {}, 0});
  ResectionOptions options;
  options.huberSigmas = 0;
  options.outlierSigmas = 1e6;
  const auto posed = resect(Camera(lens), m_poses[picture], seen, options);
  if (!posed || !posed->converged) return std::nullopt;
  count = static_cast<int>(seen.size());
  return posed->rmsPx * posed->rmsPx * count;
}

Result<void> Calibration::checkHeldOut() {
  const int count = static_cast<int>(m_pictures.size()), parts = std::min(m_options.parts, count);
  double sum = 0;
  int corners = 0, missed = 0;
  for (int part = 0; part < parts; ++part) {
    std::vector<int> kept, out;
    std::vector<RigidTransform> poses;
    for (int i = 0; i < count; ++i) (i % parts == part ? out : kept).push_back(i);
    for (const int i : kept) poses.push_back(m_poses[i]);
    if (kept.size() < 3 || refusalOfAttitudes(poses, alikeRad)) {
      missed += static_cast<int>(out.size());
      continue;
    }
    const auto made = adjust(networkOf(kept, m_sigmaPx), m_options.robust,
                             m_progress.part(0.6 + 0.4 * part / parts, 0.6 + 0.4 * (part + 1) / parts));
    if (!made) return fail(made.error());
    for (const int i : out) {
      int seen = 0;
      const auto squares = made->converged ? heldOutSquares(i, made->cameras[0], seen) : std::nullopt;
      if (!squares) {
        ++missed;
        continue;
      }
      m_summary.pictures[i].heldOutRmsPx = rootMeanSquare(*squares, seen);
      sum += *squares, corners += seen;
    }
  }
  if (corners > 0) m_summary.heldOutRmsPx = rootMeanSquare(sum, corners);
  if (missed > 0 && parts > 0)
    m_summary.warnings.push_back(fmt::format("{} of {} pictures could not be held out: the others alone do not carry a calibration",
                                             missed, count));
  constexpr double muchWorse = 2.5;
  for (const CalibratedPicture& p : m_summary.pictures)
    if (p.heldOutRmsPx && *p.heldOutRmsPx > muchWorse * std::max(p.rmsPx, m_summary.rmsPx))
      m_summary.warnings.push_back(fmt::format("{} fits with {:.2f} px when left out, with {:.2f} px otherwise: it alone fixes the "
                                               "lens where its corners lie; take more pictures with the board there", p.name, *p.heldOutRmsPx, p.rmsPx));
  return {};
}

Result<CalibrationSummary> Calibration::run(const std::vector<BoardPicture>& pictures) {
  std::vector<BoardPicture> usable;
  for (const BoardPicture& picture : pictures) {
    if (carriesPose(m_board, picture)) usable.push_back(picture);
    else m_summary.warnings.push_back(fmt::format("{} shows too little of the board ({} corners) and takes no part", picture.name, picture.corners.size()));
  }
  constexpr std::size_t fewest = 3;
  const auto tooFew = [&] {
    return refused(fmt::format("{} pictures show the board, at least {} are needed and 10 to 20 are good; take more", usable.size(), fewest));
  };
  if (usable.size() < fewest) return tooFew();
  if (const auto why = refusalOfCoverage(m_width, m_height, usable)) return refused(*why);
  const auto start = calibrationStart(m_corners, m_width, m_height, usable, m_options.model == CameraModel::OpenCvFisheye);
  if (!start) return refused("No focal length explains how the pictures show the board; check the board's size and the order of its corners");
  for (std::size_t i = 0; i < usable.size(); ++i)
    if (start->cameraFromBoard[i]) m_pictures.push_back(usable[i]), m_poses.push_back(*start->cameraFromBoard[i]);
    else m_summary.warnings.push_back(fmt::format("{} takes no part: its corners fix no pose of the board", usable[i].name));
  usable = m_pictures;
  if (usable.size() < fewest) return tooFew();
  if (const auto why = refusalOfAttitudes(m_poses, alikeAtStartRad)) return refused(*why);
  m_lens.width = m_width, m_lens.height = m_height;
  m_lens.fx = m_lens.fy = start->focalPx;
  m_lens.cx = 0.5 * (m_width - 1), m_lens.cy = 0.5 * (m_height - 1);

  const auto why = fit();
  if (!why) return fail(why.error());
  // What went wrong shows best in the attitudes that it started from.
  constexpr double alikeBeforeRad = 0.12;
  if (*why) return refused(refusalOfAttitudes(m_poses, alikeBeforeRad).value_or(**why));
  if (const auto alike = refusalOfAttitudes(m_poses, alikeRad)) return refused(*alike);
  if (const auto weak = refusalOfAccuracy(m_summary)) return refused(*weak);
  if (const auto checked = checkHeldOut(); !checked) return fail(checked.error());
  m_summary.converged = true;
  m_summary.reason = "Converged";
  return m_summary;
}

}  // namespace

Result<void> CalibrationOptions::validate() const {
  if (!std::isfinite(boardSigmaM) || boardSigmaM < 0 || boardSigmaM > 1)
    return fail("The board's standard deviation must lie between 0 and 1 m", "boardSigmaM", "Give 0.0002 for a good print, or 0");
  if (parts < 0 || parts == 1 || parts > 1000)
    return fail("The held-out check needs two parts or more", "parts", "Give 5, or 0 for no check");
  return {};
}

Result<CalibrationSummary> calibrateCamera(const Board& board, int width, int height, const std::vector<BoardPicture>& pictures,
                                           const CalibrationOptions& options, const Progress& progress) {
  if (const auto valid = options.validate(); !valid) return fail(valid.error());
  if (const auto good = checkBoardPictures(board, width, height, pictures); !good) return fail(good.error());
  return Calibration(board, width, height, options, progress).run(pictures);
}

}  // namespace alidade
