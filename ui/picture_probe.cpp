// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/picture_probe.h"

#include <cmath>
#include <limits>

#include "overlay/annotation_painter.h"

namespace alidade {

namespace {

DesignId designOfModel(const RenderResult& result, const DesignModel* model) {
  for (const auto& [id, loaded] : result.request.data->designs)
    if (loaded.get() == model) return id;
  return {};
}

}  // namespace

PictureProbe::PictureProbe(std::shared_ptr<const RenderResult> result) : m_result(std::move(result)) {
  if (!m_result) return;
  const FrameDescription& description = m_result->frame.description;
  const ColourImage& colour = m_result->frame.picture.colour;
  if (m_result->problem) {
    m_rawWidth = colour.width();
    m_rawHeight = colour.height();
    return;
  }
  m_rawWidth = description.camera.width();
  m_rawHeight = description.camera.height();
  m_scaledCamera = description.camera.scaledTo(colour.width(), colour.height());
  if (m_rawWidth > 0) m_scale = static_cast<double>(colour.width()) / m_rawWidth;
}

glm::dvec2 PictureProbe::resultFromRaw(const glm::dvec2& raw) const {
  const ColourImage& colour = m_result->frame.picture.colour;
  const glm::dvec2 scale(static_cast<double>(colour.width()) / m_rawWidth,
                         static_cast<double>(colour.height()) / m_rawHeight);
  return (raw + 0.5) * scale - 0.5;
}

CursorReadout PictureProbe::readout(const glm::dvec2& raw) const {
  if (!hasPose()) return {};
  return readoutAt(m_result->frame, resultFromRaw(raw));
}

std::optional<PictureProbe::Element> PictureProbe::elementAt(const glm::dvec2& raw) const {
  if (!hasPose()) return std::nullopt;
  const OverlayPicture& picture = m_result->frame.picture;
  const glm::dvec2 px = resultFromRaw(raw);
  const int x = static_cast<int>(std::lround(px.x)), y = static_cast<int>(std::lround(px.y));
  if (!picture.element.contains(x, y)) return std::nullopt;
  const std::uint32_t id = picture.element.at(x, y);
  if (id == 0) return std::nullopt;
  const auto& firsts = picture.firstElementOfLayer;
  const auto& layers = m_result->frame.description.designs;
  for (std::size_t layer = std::min(firsts.size(), layers.size()); layer-- > 0;) {
    if (id - 1 < firsts[layer]) continue;
    const DesignId design = designOfModel(*m_result, layers[layer].model.get());
    return Element{design, static_cast<int>(id - 1 - firsts[layer])};
  }
  return std::nullopt;
}

AnnotationId PictureProbe::annotationAt(const glm::dvec2& raw) const {
  if (!hasPose() || !m_result->request.display.annotations) return {};
  return alidade::annotationAt(m_result->frame.description, m_scaledCamera, resultFromRaw(raw));
}

std::string PictureProbe::stakePointAt(const glm::dvec2& raw, double radius) const {
  if (!hasPose() || !m_result->request.display.stakePoints) return {};
  std::string best;
  double nearest = radius;
  for (const StakePoint& point : m_result->frame.description.stakePoints) {
    const auto pixel = project(point.position);
    if (!pixel) continue;
    const double distance = glm::length(*pixel - raw);
    if (distance < nearest) nearest = distance, best = point.name;
  }
  return best;
}

std::optional<glm::dvec2> PictureProbe::project(const glm::dvec3& world) const {
  if (!hasPose()) return std::nullopt;
  const FrameDescription& description = m_result->frame.description;
  return description.camera.project(description.cameraFromWorld * world);
}

double PictureProbe::scanDepth(const glm::dvec2& raw) const {
  if (!hasPose()) return std::numeric_limits<double>::quiet_NaN();
  const DepthImage& depth = m_result->frame.picture.scanDepth;
  const glm::dvec2 px = resultFromRaw(raw);
  const int x = static_cast<int>(std::lround(px.x)), y = static_cast<int>(std::lround(px.y));
  if (!depth.contains(x, y) || !std::isfinite(depth.at(x, y)))
    return std::numeric_limits<double>::quiet_NaN();
  return depth.at(x, y);
}

const ColourImage* PictureProbe::rawPicture() const {
  return m_result ? m_result->frame.description.image.get() : nullptr;
}

std::optional<ElementShares> sharesOf(const RenderResult& result, DesignId design, int element) {
  if (element < 0 || result.problem) return std::nullopt;
  const auto& layers = result.frame.description.designs;
  for (const ElementPixels& counted : result.frame.picture.elements) {
    if (counted.element != static_cast<std::uint32_t>(element) || counted.layer >= layers.size()) continue;
    if (designOfModel(result, layers[counted.layer].model.get()) != design) continue;
    const std::uint64_t all = counted.visible + counted.hidden + counted.unknown;
    if (all == 0) return std::nullopt;
    const double n = static_cast<double>(all);
    return ElementShares{static_cast<double>(counted.visible) / n, static_cast<double>(counted.hidden) / n,
                         static_cast<double>(counted.unknown) / n, all};
  }
  return std::nullopt;
}

}  // namespace alidade
