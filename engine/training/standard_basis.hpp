/// The principal components shared by all libraries.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "engine/options/train_options.hpp"
#include "storage/common/result.hpp"
#include "storage/data/tri_spin_features.hpp"

namespace trivet::engine {

/// The basis of the Tri-Spin-Images of all libraries, with the first components according to the
/// options; empty if they exclude Tri-Spin-Images.
///
/// A basis computed from a library's own images, as in Guo et al. (IJCV 2013), changes with each
/// added or removed model, and with it the features of all models. This basis was computed once,
/// from images of machine parts and household objects (apps/make_basis.cpp), so that a model's
/// features depend on the model alone.
TriSpinBasis standard_basis(const TrainOptions& options);

/// A basis in the program's binary format, little endian: support, code step, variance of all
/// dimensions (f32), components (u32); mean, variance of each component, components (f32).
std::string basis_bytes(const TriSpinBasis& basis);
/// Parse a basis. Errors: bad_data (too short or too long).
Result<TriSpinBasis> parse_basis(std::string_view bytes);

}  // namespace trivet::engine
