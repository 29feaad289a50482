/// Positions or directions as three columns: one owner and two views that are passed by value.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "storage/common/columns.hpp"
#include "storage/common/precondition.hpp"

namespace trivet {

/// Read-only view of n vectors; valid while the owner lives and keeps its size.
struct PointsView {
  std::span<const float> x, y, z;  // equal lengths

  std::size_t size() const noexcept { return x.size(); }
  bool empty() const noexcept { return x.empty(); }
  Eigen::Vector3f operator[](std::size_t i) const noexcept { return {x[i], y[i], z[i]}; }
  PointsView slice(std::size_t first, std::size_t count) const {
    TRIVET_REQUIRE(first <= size() && count <= size() - first, "a slice within the points");
    return {x.subspan(first, count), y.subspan(first, count), z.subspan(first, count)};
  }
};

/// Writable view of n vectors; valid while the owner lives and keeps its size.
struct PointsSpan {
  std::span<float> x, y, z;  // equal lengths

  std::size_t size() const noexcept { return x.size(); }
  void set(std::size_t i, const Eigen::Vector3f& v) const noexcept {
    x[i] = v.x();
    y[i] = v.y();
    z[i] = v.z();
  }
  operator PointsView() const noexcept { return {x, y, z}; }  // NOLINT: reading is always allowed
  PointsSpan slice(std::size_t first, std::size_t count) const {
    TRIVET_REQUIRE(first <= size() && count <= size() - first, "a slice within the points");
    return {x.subspan(first, count), y.subspan(first, count), z.subspan(first, count)};
  }
};

using NormalsView = PointsView;  ///< unit vectors; NaN: no normal
/// Writable view of unit vectors.
using NormalsSpan = PointsSpan;

/// Read-only view of points with one normal each.
struct OrientedView {
  PointsView points;
  NormalsView normals;
};

/// Writable view of points with one normal each.
struct OrientedSpan {
  PointsSpan points;
  NormalsSpan normals;
};

/// Owning storage: three aligned columns of equal length.
class Points {
 public:
  Points() = default;
  explicit Points(std::size_t n) : x_(n), y_(n), z_(n) {}
  explicit Points(PointsView from)
      : x_(from.x.begin(), from.x.end()),
        y_(from.y.begin(), from.y.end()),
        z_(from.z.begin(), from.z.end()) {}

  std::size_t size() const noexcept { return x_.size(); }
  bool empty() const noexcept { return x_.empty(); }
  Eigen::Vector3f operator[](std::size_t i) const noexcept { return {x_[i], y_[i], z_[i]}; }
  PointsView view() const noexcept { return {x_, y_, z_}; }
  PointsSpan span() noexcept { return {x_, y_, z_}; }
  operator PointsView() const noexcept { return view(); }  // NOLINT: an owner reads as its view
  operator PointsSpan() noexcept { return span(); }        // NOLINT

  void set(std::size_t i, const Eigen::Vector3f& v) noexcept { span().set(i, v); }
  void push_back(const Eigen::Vector3f& v) {
    x_.push_back(v.x());
    y_.push_back(v.y());
    z_.push_back(v.z());
  }
  void reserve(std::size_t n) {
    x_.reserve(n);
    y_.reserve(n);
    z_.reserve(n);
  }
  void resize(std::size_t n) {
    x_.resize(n);
    y_.resize(n);
    z_.resize(n);
  }

 private:
  Column<float> x_, y_, z_;
};

/// Owning storage of unit vectors.
using Normals = Points;

}  // namespace trivet
