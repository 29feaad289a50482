/// Manual pages and completions, tested as their readers use them.
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "apps/help/completion.hpp"
#include "apps/options/describe_command.hpp"
#include "apps/program.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

const std::vector<std::string> kPages{"trivet",    "train", "recognize", "evaluate",
                                      "compare",   "scan",  "mesh",      "calibrate",
                                      "fit-score", "study", "serve",     "library"};

class Help : public testing::Test {
 protected:
  test::Outcome shell(const std::string& line) const {
    return test::run_program("/bin/bash", {"-c", line},
                             {.folder = folder_.path(), .environment = {}, .watch = {}});
  }
  void write_page(const std::string& name) const {
    const test::Outcome page = shell(TRIVET_PROGRAM " --man " + name);
    ASSERT_EQ(page.exit_code, 0) << page.error;
    folder_.write(name + ".1", page.out);
  }
  /// The completions that bash offers for the last of these words, one per line.
  std::string offered(const std::string& words) const {
    const test::Outcome outcome = shell("source <(" TRIVET_PROGRAM
                                        " --completion bash); "
                                        "COMP_WORDS=(" +
                                        words +
                                        "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _trivet; "
                                        "printf '%s\\n' \"${COMPREPLY[@]}\"");
    EXPECT_EQ(outcome.error, "") << words;
    return outcome.out;
  }
  const test::TempDir folder_;
};

TEST_F(Help, HasAPageForEveryCommand) {
  for (const std::string& name : kPages) {
    write_page(name);
    const std::string page = test::read_bytes(folder_ / (name + ".1"));
    EXPECT_TRUE(page.starts_with(".TH TRIVET")) << name;
    for (const char* section : {".SH NAME\n", ".SH SYNOPSIS\n", ".SH EXIT STATUS\n"})
      EXPECT_NE(page.find(section), std::string::npos) << name << section;
  }
  const std::string page = test::read_bytes(folder_ / "recognize.1");
  for (const char* text : {"\\fB\\-\\-unit\\fR", ".SS For research: voting, first round",
                           "Default: fused", "\\fBtrivet\\-fit\\-score\\fR(1)"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
  EXPECT_EQ(shell(TRIVET_PROGRAM " --man nothing").exit_code, 2);
}

TEST_F(Help, WritesPagesWithoutFaults) {
  if (shell("command -v man").exit_code != 0) GTEST_SKIP() << "needs man";
  for (const std::string& name : kPages) {
    write_page(name);
    const test::Outcome outcome =
        shell("LC_ALL=C.UTF-8 MANWIDTH=90 man --warnings -E UTF-8 -l " + name + ".1");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_EQ(outcome.error, "") << name;
    EXPECT_NE(outcome.out.find("SYNOPSIS"), std::string::npos) << name;
  }
}

// Pages have no date, like all other output of the program.
TEST_F(Help, WritesPagesThatMandocFindsNoFaultWith) {
  if (shell("command -v mandoc").exit_code != 0) GTEST_SKIP() << "needs mandoc";
  for (const std::string& name : kPages) {
    write_page(name);
    EXPECT_EQ(shell("mandoc -T lint -W warning " + name + ".1 | grep -v 'missing date'").out, "")
        << name;
  }
}

TEST_F(Help, CompletesCommandsOptionsAndTheirValuesInBash) {
  EXPECT_EQ(offered("trivet rec"), "recognize\n");
  EXPECT_EQ(offered("trivet library ''").find("list\ninfo\nverify\nfamilies\ndiff\nadd\n"), 0U);
  EXPECT_EQ(offered("trivet library info --j"), "--json\n");
  EXPECT_EQ(offered("trivet --threads 2 recognize --meth"), "--method\n");
  EXPECT_EQ(offered("trivet recognize --qui"), "--quiet\n") << "of all commands";
  EXPECT_EQ(offered("trivet recognize --method ''"), "fused\nppf\ntrisi\n");
  EXPECT_EQ(offered("trivet recognize --method = p"), "ppf\n") << "as --method=p reaches it";
  EXPECT_EQ(offered("trivet recognize --ablate clusters,pl"), "clusters,planes\n");
  EXPECT_EQ(offered("trivet train --unit ''"), "m\nmm\n");
  EXPECT_EQ(offered("trivet mesh --method gr"), "grid\ngreedy\n");
  EXPECT_EQ(offered("trivet scan --families bracket,hex"), "bracket,hex_nut\n");
  EXPECT_EQ(offered("trivet --man fit"), "fit-score\n");
}

TEST_F(Help, CompletesNamesOfFilesInBash) {
  folder_.write("lib.h5", "");
  folder_.write("my scan.ply", "");
  EXPECT_EQ(offered("trivet recognize l"), "lib.h5\n");
  EXPECT_EQ(offered("trivet recognize lib.h5 m"), "my scan.ply\n");
  EXPECT_EQ(offered("trivet recognize --camera l"), "lib.h5\n");
  EXPECT_EQ(offered("trivet recognize --rounds ''"), "\n") << "a number";
}

TEST_F(Help, CompletesInFish) {
  if (shell("command -v fish").exit_code != 0) GTEST_SKIP() << "needs fish";
  const auto offered = [&](const std::string& line) {
    const test::Outcome outcome =
        shell("HOME=$PWD fish -c \"" TRIVET_PROGRAM " --completion fish | source; complete -C '" +
              line + "'\" | cut -f 1");
    EXPECT_EQ(outcome.error, "") << line;
    return outcome.out;
  };
  EXPECT_EQ(offered("trivet rec"), "recognize\n");
  EXPECT_EQ(offered("trivet library inf"), "info\n");
  EXPECT_EQ(offered("trivet recognize --method "), "fused\nppf\ntrisi\n");
  EXPECT_EQ(offered("trivet recognize --ablate clusters,pl"), "clusters,planes\n");
}

TEST_F(Help, IsAcceptedByZsh) {
  if (shell("command -v zsh").exit_code != 0) GTEST_SKIP() << "needs zsh";
  const test::Outcome outcome =
      shell(TRIVET_PROGRAM
            " --completion zsh > _trivet && zsh -f -c 'fpath=($PWD $fpath); "
            "autoload -Uz compinit; compinit -u -D; autoload +X _trivet; print $_comps[trivet]'");
  EXPECT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.out, "_trivet\n");
}

// Shell metacharacters in a description or a value stay part of that text.
TEST_F(Help, QuotesShellSyntax) {
  CLI::App app{"It's $(odd)"};
  std::string value;
  app.add_option("--odd", value, "It's [an] option: `x` \\ $HOME \"y\"");
  app.add_subcommand("one", "It's: one");
  const apps::CommandHelp program = apps::describe_command(app, "trivet");
  for (const std::string shell_name : {"bash", "zsh", "fish"}) {
    folder_.write("script", apps::completion(program, shell_name));
    if (shell("command -v " + shell_name).exit_code != 0) continue;
    const test::Outcome outcome = shell(shell_name + " -n script");
    EXPECT_EQ(outcome.exit_code, 0) << shell_name << outcome.error;
  }
}

}  // namespace
}  // namespace trivet
