/// Metrics of this process, under the names that all Prometheus client libraries use.
///
/// Source: https://prometheus.io/docs/instrumenting/writing_clientlibs, "Process metrics"; proc(5).
#pragma once

#include <prometheus/metric_family.h>

#include <vector>

namespace trivet::apps::service {

/// Current processor time, memory, open files and start time. Values that cannot be read are left
/// out.
std::vector<prometheus::MetricFamily> process_metrics();

}  // namespace trivet::apps::service
