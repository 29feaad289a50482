/// What the system knows of this process, by the names that all clients of Prometheus give it.
///
/// Source: https://prometheus.io/docs/instrumenting/writing_clientlibs, "Process metrics"; proc(5).
#pragma once

#include <prometheus/metric_family.h>

#include <vector>

namespace trivet::apps::service {

/// Processor time, memory, open files and the time of the start, as they are now; what cannot be
/// read is left out.
std::vector<prometheus::MetricFamily> process_metrics();

}  // namespace trivet::apps::service
