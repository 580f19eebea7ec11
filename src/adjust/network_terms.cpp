// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/network_terms.h"

#include <map>

#include <Eigen/Cholesky>

namespace alidade {

namespace {

/// Nearer than this to the camera's plane a point counts as behind it.
constexpr double nearest = 1e-9;

void scaleRows(TermValue& value, double factor, const NetworkLayout& layout, const Term& term, bool derivatives) {
  for (int r = 0; r < value.rows; ++r) value.residual[r] *= factor;
  if (!derivatives) return;
  for (int i = 0; i < 3 * value.rows; ++i) value.byPoint[i] *= factor;
  for (int b = 0; b < 3; ++b)
    if (term.blocks[b] >= 0)
      for (int i = 0; i < value.rows * layout.blocks[term.blocks[b]].size; ++i) value.byBlock[b][i] *= factor;
}

}  // namespace

NetworkTerms::NetworkTerms(const Network& network, const NetworkLayout& layout) : m_network(network), m_layout(layout) {
  addObservations();
  addMotion();
}

Term NetworkTerms::frameTerm(int frame) const {
  const NetworkFrame& seen = m_network.frames[frame];
  Term term;
  term.frame = frame;
  term.blocks = {m_layout.poseBlock[seen.pose], seen.mount < 0 ? -1 : m_layout.mountBlock[seen.mount],
                 m_layout.cameraBlock[seen.camera]};
  return term;
}

int NetworkTerms::rowPose(int frame, const glm::dvec2& pixel) {
  const NetworkFrame& seen = m_network.frames[frame];
  if (!seen.shutter.isOn()) return -1;
  const int height = m_network.cameras[seen.camera].intrinsics.height;
  const RigidTransform rowFromMiddle = exponential(seen.shutter.motion * seen.shutter.secsAtRow(pixel.y, height));
  m_rowPoses.push_back({rowFromMiddle.rotationMatrix(), rowFromMiddle.translation});
  return static_cast<int>(m_rowPoses.size()) - 1;
}

void NetworkTerms::addObservations() {
  const auto add = [&](Term term, ResidualKind kind, std::size_t index, int point, bool heldOut, bool robust) {
    term.kind = kind, term.index = static_cast<int>(index), term.point = point;
    term.slot = point < 0 ? -1 : m_layout.pointSlot[point];
    term.heldOut = heldOut, term.robust = robust;
    m_terms.push_back(term);
  };
  std::map<std::pair<int, int>, int> rows;  // of a frame's points, for their depths
  constexpr std::array kinds{ResidualKind::Control, ResidualKind::Scan, ResidualKind::Tie};
  for (std::size_t i = 0; i < m_network.observations.size(); ++i) {
    const PictureObservation& o = m_network.observations[i];
    const auto kind = kinds[static_cast<std::size_t>(m_network.points[o.point].kind)];
    Term term = frameTerm(o.frame);
    term.row = rowPose(o.frame, o.pixel);
    if (term.row >= 0 && !m_network.depths.empty()) rows[{o.frame, o.point}] = term.row;
    add(term, kind, i, o.point, o.heldOut, true);
  }
  for (std::size_t i = 0; i < m_network.edges.size(); ++i) {
    const EdgeObservation& o = m_network.edges[i];
    Term term = frameTerm(o.frame);
    term.row = rowPose(o.frame, o.pixel);
    add(term, ResidualKind::Edge, i, -1, o.heldOut, true);
  }
  for (std::size_t i = 0; i < m_network.depths.size(); ++i) {
    const DepthObservation& o = m_network.depths[i];
    Term term = frameTerm(o.frame);
    term.blocks[2] = -1;
    if (const auto seen = rows.find({o.frame, o.point}); seen != rows.end()) term.row = seen->second;
    add(term, ResidualKind::Depth, i, o.point, o.heldOut, true);
  }
  for (std::size_t i = 0; i < m_network.points.size(); ++i) {
    const NetworkPoint& point = m_network.points[i];
    if (point.kind == PointKind::Tie && point.surface)
      add({}, ResidualKind::Surface, i, static_cast<int>(i), false, true);
    if (point.kind != PointKind::Tie && m_layout.pointSlot[i] >= 0)
      add({}, ResidualKind::Coordinates, i, static_cast<int>(i), false, false);
  }
}

void NetworkTerms::addMotion() {
  const auto poseTerm = [&](ResidualKind kind, std::size_t index, std::array<int, 3> blocks) {
    Term term;
    term.kind = kind, term.index = static_cast<int>(index), term.blocks = blocks;
    m_terms.push_back(term);
  };
  for (std::size_t i = 0; i < m_network.priors.size(); ++i) {
    const PosePrior& prior = m_network.priors[i];
    std::vector<int> known;
    for (int k = 0; k < 6; ++k)
      if (prior.covariance[k][k] > 0) known.push_back(k);
    Eigen::MatrixXd covariance(known.size(), known.size());
    for (std::size_t r = 0; r < known.size(); ++r)
      for (std::size_t c = 0; c < known.size(); ++c) covariance(r, c) = prior.covariance[known[r]][known[c]];
    const Eigen::MatrixXd factor = covariance.llt().matrixL();
    const Eigen::MatrixXd inverse = factor.triangularView<Eigen::Lower>().solve(
        Eigen::MatrixXd::Identity(factor.rows(), factor.cols()));
    PriorForm form;
    for (std::size_t r = 0; r < known.size(); ++r)
      for (std::size_t c = 0; c <= r; ++c) form.whitening(known[r], known[c]) = inverse(r, c);
    m_priors.push_back(form);
    poseTerm(ResidualKind::Prior, i, {m_layout.poseBlock[prior.pose], -1, -1});
  }
  for (std::size_t t = 0; t < m_network.trajectories.size(); ++t)
    for (const int pose : m_network.trajectories[t].poses) {
      poseTerm(ResidualKind::Trajectory, m_trajectoryUses.size(), {m_layout.poseBlock[pose], m_layout.clockBlock[t], -1});
      m_trajectoryUses.push_back({static_cast<int>(t), pose});
    }
  for (std::size_t s = 0; s < m_network.smoothness.size(); ++s) {
    const std::vector<int>& poses = m_network.smoothness[s].poses;
    for (std::size_t i = 2; i < poses.size(); ++i) {
      poseTerm(ResidualKind::Smoothness, m_smoothnessUses.size(),
               {m_layout.poseBlock[poses[i - 2]], m_layout.poseBlock[poses[i - 1]], m_layout.poseBlock[poses[i]]});
      m_smoothnessUses.push_back({static_cast<int>(s), poses[i - 2], poses[i - 1], poses[i]});
    }
  }
}

glm::dvec3 NetworkTerms::Prepared::View::inCamera(const glm::dvec3& pointFromOrigin) const {
  const glm::dvec3 inBody = bodyFromWorld * (pointFromOrigin - centre);
  return mounted ? cameraFromBody * inBody + translation : inBody;
}

NetworkTerms::Prepared NetworkTerms::prepare(const NetworkState& state) const {
  Prepared prepared;
  prepared.views.reserve(m_network.frames.size());
  for (const NetworkFrame& frame : m_network.frames) {
    Prepared::View view;
    view.bodyFromWorld = glm::mat3_cast(state.poses[frame.pose].rotation);
    view.centre = state.poses[frame.pose].centre;
    view.mounted = frame.mount >= 0;
    if (view.mounted) {
      view.cameraFromBody = glm::mat3_cast(state.mounts[frame.mount].rotation);
      view.translation = state.mounts[frame.mount].translation;
    }
    view.camera = &state.cameras[frame.camera];
    view.cameraVaries = m_layout.cameraBlock[frame.camera] >= 0;
    prepared.views.push_back(view);
  }
  return prepared;
}

bool NetworkTerms::project(const Prepared& prepared, const Term& term, const glm::dvec3& point, bool derivatives,
                           TermValue& to) const {
  const Prepared::View& view = prepared.views[term.frame];
  const glm::dvec3 inBody = view.bodyFromWorld * (point - view.centre);
  const glm::dvec3 turned = view.mounted ? view.cameraFromBody * inBody : inBody;
  const glm::dvec3 inCamera = view.mounted ? turned + view.translation : inBody;
  const RowPose* row = term.row < 0 ? nullptr : &m_rowPoses[term.row];
  const glm::dvec3 p = row ? *row * inCamera : inCamera;
  to.rows = 2;
  if (!(p.z > nearest)) return false;
  if (!derivatives) {
    const glm::dvec2 pixel = view.camera->project(p);
    to.residual[0] = pixel.x, to.residual[1] = pixel.y;
    return std::isfinite(pixel.x + pixel.y);
  }
  VaryingCamera::Projection at;
  const int calibration = term.blocks[2];
  view.camera->project(p, calibration >= 0, at);
  to.residual[0] = at.pixel.x, to.residual[1] = at.pixel.y;
  const glm::dvec3 rows[2] = {row ? at.du * row->rotation : at.du, row ? at.dv * row->rotation : at.dv};
  for (int r = 0; r < 2; ++r) {
    const glm::dvec3 byBody = view.mounted ? rows[r] * view.cameraFromBody : rows[r];
    const glm::dvec3 byPoint = byBody * view.bodyFromWorld;
    for (int i = 0; i < 3; ++i) to.byPoint[3 * r + i] = byPoint[i];
    if (term.blocks[0] >= 0) {
      const glm::dvec3 byRotation = glm::cross(inBody, byBody);
      for (int i = 0; i < 3; ++i) to.byBlock[0][6 * r + i] = -byPoint[i], to.byBlock[0][6 * r + 3 + i] = byRotation[i];
    }
    if (term.blocks[1] >= 0) {
      const glm::dvec3 byRotation = glm::cross(turned, rows[r]);
      for (int i = 0; i < 3; ++i) to.byBlock[1][6 * r + i] = rows[r][i], to.byBlock[1][6 * r + 3 + i] = byRotation[i];
    }
    if (calibration >= 0) {
      const int n = view.camera->parameterCount();
      for (int i = 0; i < n; ++i) to.byBlock[2][n * r + i] = at.byParameter[i][r];
    }
  }
  return std::isfinite(at.pixel.x + at.pixel.y);
}

/// The place on the line whose picture is nearest to the pixel, found by Newton's steps along the line; there the
/// picture moves along the edge only, so that the residual across it has the derivatives of that place held still.
bool NetworkTerms::edge(const Prepared& prepared, const Term& term, bool derivatives, TermValue& to) const {
  const EdgeObservation& seen = m_network.edges[term.index];
  const Prepared::View& view = prepared.views[term.frame];
  const glm::dvec3 from = seen.from - m_layout.origin, along = seen.to - seen.from;
  const auto inCamera = [&](const glm::dvec3& point) {
    const glm::dvec3 p = view.inCamera(point);
    return term.row < 0 ? p : m_rowPoses[term.row] * p;
  };
  const glm::dvec3 start = inCamera(from), end = inCamera(from + along), d = end - start;
  // A place before the camera to begin with: the middle of what is at least a tenth of the farther end's depth.
  const double farther = std::max(start.z, end.z);
  if (!(farther > nearest)) return false;
  double low = 0, high = 1;
  if (start.z < 0.1 * farther) low = (0.1 * farther - start.z) / d.z;
  if (end.z < 0.1 * farther) high = (0.1 * farther - start.z) / d.z;
  double s = 0.5 * (low + high);
  VaryingCamera::Projection at;
  for (int i = 0; i < 12; ++i) {
    const glm::dvec3 p = start + s * d;
    view.camera->project(p, false, at);
    const glm::dvec2 tangent(glm::dot(at.du, d), glm::dot(at.dv, d));
    double step = -glm::dot(at.pixel - seen.pixel, tangent) / glm::dot(tangent, tangent);
    if (!std::isfinite(step)) return false;
    // Half way to the camera's plane at most.
    if (p.z + step * d.z < 0.5 * p.z) step = -0.5 * p.z / d.z;
    s += step;
    if (std::abs(step) < 1e-13 * (1 + std::abs(s))) break;
  }
  if (!project(prepared, term, from + s * along, true, to)) return false;
  view.camera->project(start + s * d, false, at);
  const glm::dvec2 tangent(glm::dot(at.du, d), glm::dot(at.dv, d));
  const double length = glm::length(tangent);
  if (!(length > 0)) return false;
  const glm::dvec2 across(-tangent.y / length, tangent.x / length);
  const glm::dvec2 off(to.residual[0] - seen.pixel.x, to.residual[1] - seen.pixel.y);
  const double distance = glm::dot(across, off);
  to.pixels = distance * across;
  to.rows = 1;
  to.residual[0] = distance;
  if (derivatives) {
    for (int b = 0; b < 3; ++b) {
      if (term.blocks[b] < 0) continue;
      const int n = m_layout.blocks[term.blocks[b]].size;
      for (int i = 0; i < n; ++i) to.byBlock[b][i] = across.x * to.byBlock[b][i] + across.y * to.byBlock[b][n + i];
    }
  }
  scaleRows(to, 1 / seen.sigmaPx, m_layout, term, derivatives);
  return true;
}

bool NetworkTerms::depth(const Prepared& prepared, const Term& term, const NetworkState& state, bool derivatives,
                         TermValue& to) const {
  const DepthObservation& seen = m_network.depths[term.index];
  const Prepared::View& view = prepared.views[term.frame];
  const glm::dvec3 inBody = view.bodyFromWorld * (state.points[term.point] - view.centre);
  const glm::dvec3 turned = view.mounted ? view.cameraFromBody * inBody : inBody;
  const glm::dvec3 inCamera = view.mounted ? turned + view.translation : inBody;
  const RowPose* seenAt = term.row < 0 ? nullptr : &m_rowPoses[term.row];
  const double z = seenAt ? (*seenAt * inCamera).z : inCamera.z;
  to.rows = 1;
  to.residual[0] = to.metres = z - seen.depthM;
  if (derivatives) {
    const glm::dvec3 axis(0, 0, 1), row = seenAt ? axis * seenAt->rotation : axis;
    const glm::dvec3 byBody = view.mounted ? row * view.cameraFromBody : row;
    const glm::dvec3 byPoint = byBody * view.bodyFromWorld, byRotation = glm::cross(inBody, byBody);
    const glm::dvec3 byMount = glm::cross(turned, row);
    for (int i = 0; i < 3; ++i) {
      to.byPoint[i] = byPoint[i];
      to.byBlock[0][i] = -byPoint[i], to.byBlock[0][3 + i] = byRotation[i];
      to.byBlock[1][i] = row[i], to.byBlock[1][3 + i] = byMount[i];
    }
  }
  scaleRows(to, 1 / seen.sigmaM, m_layout, term, derivatives);
  return true;
}

bool NetworkTerms::evaluate(const NetworkState& state, const Prepared& prepared, const Term& term, bool derivatives,
                            TermValue& to) const {
  switch (term.kind) {
    case ResidualKind::Control:
    case ResidualKind::Scan:
    case ResidualKind::Tie: {
      const PictureObservation& seen = m_network.observations[term.index];
      if (!project(prepared, term, state.points[term.point], derivatives, to)) return false;
      to.residual[0] -= seen.pixel.x, to.residual[1] -= seen.pixel.y;
      to.pixels = {to.residual[0], to.residual[1]};
      scaleRows(to, 1 / seen.sigmaPx, m_layout, term, derivatives);
      return true;
    }
    case ResidualKind::Edge: return edge(prepared, term, derivatives, to);
    case ResidualKind::Depth: return depth(prepared, term, state, derivatives, to);
    case ResidualKind::Surface: {
      const SurfaceHold& hold = *m_network.points[term.point].surface;
      const glm::dvec3 n = glm::normalize(hold.normal) / hold.sigmaM;
      to.rows = 1;
      to.residual[0] = glm::dot(n, state.points[term.point] - (hold.through - m_layout.origin));
      to.metres = hold.sigmaM * to.residual[0];
      for (int i = 0; i < 3; ++i) to.byPoint[i] = n[i];
      return true;
    }
    case ResidualKind::Coordinates: {
      const NetworkPoint& point = m_network.points[term.point];
      const glm::dvec3 off = state.points[term.point] - (*point.world - m_layout.origin);
      to.rows = 3;
      for (int i = 0; i < 3; ++i) {
        // An axis without a standard deviation beside others that have one is known to a micrometre.
        const double sigma = std::max(1e-6, point.sigmaM[i]);
        to.residual[i] = off[i] / sigma;
        for (int j = 0; j < 3; ++j) to.byPoint[3 * i + j] = i == j ? 1 / sigma : 0;
      }
      return true;
    }
    case ResidualKind::Prior: {
      const PosePrior& prior = m_network.priors[term.index];
      poseDifference(state.poses[prior.pose], stateOf(prior.bodyFromWorld, m_layout.origin),
                     m_priors[term.index].whitening, derivatives, to);
      return true;
    }
    case ResidualKind::Trajectory: return trajectory(state, term, derivatives, to);
    case ResidualKind::Smoothness: smooth(state, term, derivatives, to); return true;
  }
  return false;
}

}  // namespace alidade
