/// Names and sizes of rows.
#pragma once

#include <benchmark/benchmark.h>

#include <string>

#include "scan.hpp"

namespace trivet::bench {

/// A row of one stage and implementation: body(state, scan) runs the timed loop and adds counters.
/// The last part of its name is the width of the scan, whose aspect ratio is 4 : 3.
template <class Body>
benchmark::internal::Benchmark* add_row(const std::string& name, Body body) {
  return benchmark::RegisterBenchmark(
             name.c_str(),
             [body](benchmark::State& state) {
               const Scan& scan = scan_of_width(state.range(0));
               body(state, scan);
               state.SetItemsProcessed(state.iterations() *
                                       static_cast<std::int64_t>(scan.points.size()));
             })
      ->Unit(benchmark::kMillisecond);
}

/// A row over all sizes.
template <class Body>
bool add_rows(const std::string& name, Body body) {
  auto* row = add_row(name, body);
  for (const std::int64_t width : kWidths) row->Arg(width);
  return true;
}

/// A row at the size that a quadratic algorithm can handle.
template <class Body>
bool add_naive_row(const std::string& name, Body body) {
  add_row(name, body)->Arg(kNaiveWidth);
  return true;
}

}  // namespace trivet::bench
