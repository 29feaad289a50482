/// The principal components that all libraries share.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "engine/options/train_options.hpp"
#include "storage/common/result.hpp"
#include "storage/data/tri_spin_features.hpp"

namespace trivet::engine {

/// The basis of the Tri-Spin-Images of all libraries: those of the first components that the
/// options ask for; empty where they ask for no Tri-Spin-Images.
///
/// A basis of a library's own images, as Guo et al. (IJCV 2013) have it, changes with each model
/// that comes or goes, and with it the features of all models. This one was found once, from
/// images of machine parts and things of a household (apps/make_basis.cpp), so that a model's
/// features depend on the model alone.
TriSpinBasis standard_basis(const TrainOptions& options);

/// A basis as the bytes that the program carries, little endian: support, code step, variance of
/// all dimensions (f32), components (u32); mean, variance of each component, components (f32).
std::string basis_bytes(const TriSpinBasis& basis);
/// Errors: bad_data (too short or too long).
Result<TriSpinBasis> parse_basis(std::string_view bytes);

}  // namespace trivet::engine
