/// Views that keep the viewed data alive.
#pragma once

#include <concepts>
#include <memory>
#include <type_traits>
#include <utility>

namespace trivet {

/// A view of immutable columns with shared ownership: allocated memory or a mapped file. Copies
/// share the columns.
template <class View>
class Shared : public View {
 public:
  Shared() = default;
  /// owner  keeps the viewed data alive
  Shared(const View& view, std::shared_ptr<const void> owner)
      : View(view), owner_(std::move(owner)) {}
  /// Take ownership of columns, such as Points or a Column.
  template <class Owner>
  requires(!std::is_trivially_copyable_v<Owner> && !std::derived_from<Owner, View> &&
           std::convertible_to<const Owner&, View>)
      Shared(Owner owner)  // NOLINT: an owner reads as its view
      : Shared(std::make_shared<const Owner>(std::move(owner))) {}

 private:
  template <class Owner>
  explicit Shared(const std::shared_ptr<const Owner>& owner) : View(*owner), owner_(owner) {}

  std::shared_ptr<const void> owner_;
};

}  // namespace trivet
