#include "apps/study/tables.hpp"

#include "apps/results/csv_table.hpp"

namespace trivet::apps::study {
namespace {

void add_comparison(const std::optional<PairedComparison>& comparison, CsvTable& table) {
  if (!comparison) {
    table.empty(6);
    return;
  }
  table.number(comparison->difference).number(comparison->low).number(comparison->high);
  table.number(comparison->p);
  table.count(comparison->total.only_first).count(comparison->total.only_second);
}

void add_cell(const Experiment& experiment, const Panel& panel, std::size_t m, std::size_t row,
              CsvTable& table) {
  const PanelCell& cell = panel.cells[m][row];
  const auto [low, high] = cell.found.interval();
  table.row().text(experiment.name).text(panel.title).text(choice_name(panel.methods[m]));
  table.text(panel.axis).text(panel.rows[row]).count(cell.num_scenes);
  table.count(cell.found.right).count(cell.found.all).number(cell.found.value());
  table.number(low).number(high);
  if (cell.false_positives) {
    table.count(*cell.false_positives).number(cell.f1).number(cell.threshold);
  } else {
    table.empty(3);
  }
  table.count(cell.num_add_right).number(cell.translation_error).number(cell.rotation_error_deg);
  add_comparison(cell.change, table);
  add_comparison(cell.lead, table);
  table.number(cell.seconds);
}

}  // namespace

Result<void> write_study_table(const Study& study, const StudyResults& results,
                               const StudyFolder& folder) {
  CsvTable table(
      "experiment,scenes,method,setting,value,num_scenes,found,instances,share,share_low,share_"
      "high,"
      "false_alarms,f1,threshold,add_right,median_translation_error_over_diameter,"
      "median_rotation_error_deg,change,change_low,change_high,change_p,change_only_this,"
      "change_only_reference,lead,lead_low,lead_high,lead_p,lead_only_this,lead_only_first,"
      "median_seconds");
  for (std::size_t e = 0; e < study.experiments.size(); ++e) {
    for (const Panel& panel : results.experiments[e].panels) {
      for (std::size_t m = 0; m < panel.methods.size(); ++m) {
        for (std::size_t row = 0; row < panel.rows.size(); ++row)
          add_cell(study.experiments[e], panel, m, row, table);
      }
    }
  }
  TRIVET_TRY(table.write(folder.path() / "results.csv"));

  CsvTable libraries("num_models,file_bytes,open_seconds,peak_bytes");
  for (const LibraryRow& row : results.libraries) {
    libraries.row().count(row.num_models).count(row.file_bytes).number(row.use.open_seconds);
    libraries.count(row.use.peak_bytes);
  }
  return libraries.write(folder.path() / "libraries.csv");
}

}  // namespace trivet::apps::study
