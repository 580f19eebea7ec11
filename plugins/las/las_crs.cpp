// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_crs.h"

#include <cmath>
#include <cstring>
#include <memory>

#include <proj.h>

namespace alidade {

namespace {

/// A system's text longer than this is none; it bounds what a hostile file makes PROJ parse.
constexpr std::size_t kLongestText = 64 << 10;

struct Context {
  Context() { proj_log_level(context, PJ_LOG_NONE); }
  Context(const Context&) = delete;
  ~Context() { proj_context_destroy(context); }
  PJ_CONTEXT* context = proj_context_create();
};

struct Destroy {
  void operator()(PJ* object) const { proj_destroy(object); }
};
using Object = std::unique_ptr<PJ, Destroy>;

Object objectOf(const Context& in, const std::string& crs) {
  if (crs.empty() || crs.size() > kLongestText || std::strlen(crs.c_str()) != crs.size()) return nullptr;
  Object object(crs.starts_with("EPSG:") ? proj_create(in.context, crs.c_str())
                                         : proj_create_from_wkt(in.context, crs.c_str(), nullptr, nullptr, nullptr));
  return object && proj_is_crs(object.get()) ? std::move(object) : nullptr;
}

std::string wktOf(const Context& in, const PJ* object) {
  const char* const options[] = {"MULTILINE=NO", nullptr};
  const char* wkt = proj_as_wkt(in.context, object, PJ_WKT1_GDAL, options);
  return wkt != nullptr ? wkt : "";
}

/// The EPSG number as text; empty where the system states none.
std::string codeOf(const PJ* object) {
  const char* authority = proj_get_id_auth_name(object, 0);
  const char* code = proj_get_id_code(object, 0);
  return authority != nullptr && code != nullptr && std::strcmp(authority, "EPSG") == 0 ? code : "";
}

}  // namespace

std::optional<CrsUnits> crsUnits(const std::string& crs) {
  const Context in;
  Object object = objectOf(in, crs);
  if (!object) return std::nullopt;
  // The plane part of a compound system, the system itself of one that is bound to another.
  for (PJ_TYPE type = proj_get_type(object.get()); object && (type == PJ_TYPE_COMPOUND_CRS || type == PJ_TYPE_BOUND_CRS);
       type = object ? proj_get_type(object.get()) : PJ_TYPE_UNKNOWN)
    object.reset(type == PJ_TYPE_COMPOUND_CRS ? proj_crs_get_sub_crs(in.context, object.get(), 0)
                                              : proj_get_source_crs(in.context, object.get()));
  if (!object) return std::nullopt;
  const Object axes(proj_crs_get_coordinate_system(in.context, object.get()));
  double factor = 1;
  const char *unit = nullptr, *authority = nullptr, *code = nullptr;
  if (!axes || !proj_cs_get_axis_info(in.context, axes.get(), 0, nullptr, nullptr, nullptr, &factor, &unit, &authority, &code))
    return std::nullopt;
  CrsUnits units;
  units.degrees = proj_cs_get_type(in.context, axes.get()) == PJ_CS_TYPE_ELLIPSOIDAL;
  units.unit = unit != nullptr ? unit : "";
  if (!units.degrees && std::isfinite(factor) && factor > 0) units.metresPerUnit = factor;
  return units;
}

std::string wktOfEpsg(const std::string& crs) {
  if (!crs.starts_with("EPSG:")) return {};
  const Context in;
  const Object object = objectOf(in, crs);
  return object ? wktOf(in, object.get()) : std::string();
}

std::string epsgOfWkt(const std::string& wkt) {
  std::string name;
  {
    const Context in;
    const Object object = objectOf(in, wkt);
    if (!object) return {};
    if (proj_get_type(object.get()) == PJ_TYPE_COMPOUND_CRS) {
      const Object plane(proj_crs_get_sub_crs(in.context, object.get(), 0)), heights(proj_crs_get_sub_crs(in.context, object.get(), 1));
      if (!plane || !heights || codeOf(plane.get()).empty() || codeOf(heights.get()).empty()) return {};
      name = "EPSG:" + codeOf(plane.get()) + "+" + codeOf(heights.get());
    } else {
      if (codeOf(object.get()).empty()) return {};
      name = "EPSG:" + codeOf(object.get());
    }
  }
  return wktOfEpsg(name) == wkt ? name : std::string();
}

}  // namespace alidade
