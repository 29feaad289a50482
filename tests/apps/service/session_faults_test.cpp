// Inputs that a session refuses, tested without a service.
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "apps/service/serve/session/session.hpp"
#include "support/temp_dir.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::uint64_t kMaxBytes = 24 << 10;

class SessionOnItsOwn : public testing::Test {
 protected:
  void SetUp() override {
    auto opened = Session::open(folder_.path() / "cell", kMaxBytes);
    ASSERT_TRUE(opened) << opened.error().message;
    session_ = *std::move(opened);
  }

  SessionResult<KeptScan> put(const std::string& name, std::size_t num_bytes = 10,
                              LengthUnit unit = LengthUnit::meter) {
    return session_->put_scan(name, std::string(num_bytes, 'x'), {"ply", unit, {}, {}});
  }
  SessionResult<KeptScan> put_truth(const std::string& name, const std::string& expected) {
    return session_->put_truth(name, ScanTruth(std::in_place), expected,
                               [](const std::string&) { return std::nullopt; });
  }
  template <class T>
  static std::optional<SessionFault> fault_of(const SessionResult<T>& result) {
    return result ? std::nullopt : std::optional(result.error().fault);
  }

  test::TempDir folder_;
  std::unique_ptr<Session> session_;
};

TEST_F(SessionOnItsOwn, KeepsScansOfOneUnitUnderNamesOfTheirOwn) {
  ASSERT_EQ(fault_of(put("a")), std::nullopt);
  EXPECT_EQ(fault_of(put("a")), SessionFault::exists);
  EXPECT_EQ(fault_of(put("..")), SessionFault::invalid);
  EXPECT_EQ(fault_of(put("b", 10, LengthUnit::millimeter)), SessionFault::invalid);
  EXPECT_EQ(session_->contents().scans.size(), 1U);
}

TEST_F(SessionOnItsOwn, DistinguishesScansThatNeverFitFromThoseWithoutRoomNow) {
  EXPECT_EQ(fault_of(put("large", kMaxBytes + 1)), SessionFault::too_large);
  ASSERT_EQ(fault_of(put("a", 8 << 10)), std::nullopt);
  EXPECT_EQ(fault_of(put("b", 12 << 10)), SessionFault::full);
}

TEST_F(SessionOnItsOwn, KnowsWhatIsNotThere) {
  EXPECT_EQ(fault_of(session_->scan("a")), SessionFault::unknown);
  EXPECT_EQ(fault_of(session_->delete_scan("a")), SessionFault::unknown);
  EXPECT_EQ(fault_of(session_->answer("run", "a")), SessionFault::unknown);
  EXPECT_EQ(fault_of(session_->delete_run("run")), SessionFault::unknown);
  EXPECT_EQ(fault_of(put_truth("a", "")), SessionFault::unknown);
}

TEST_F(SessionOnItsOwn, ReplacesOnlyTheTruthThatIsExpected) {
  const SessionResult<KeptScan> scan = put("a");
  ASSERT_EQ(fault_of(scan), std::nullopt);
  const SessionResult<KeptScan> stale = put_truth("a", "\"another\"");
  ASSERT_EQ(fault_of(stale), SessionFault::stale);
  ASSERT_TRUE(stale.error().kept_scan);
  EXPECT_FALSE(stale.error().kept_scan->scan.is_marked);
  const SessionResult<KeptScan> marked = put_truth("a", truth_version((*scan).scan));
  ASSERT_EQ(fault_of(marked), std::nullopt);
  EXPECT_TRUE((*marked).scan.is_marked);
}

}  // namespace
}  // namespace trivet::apps::service
