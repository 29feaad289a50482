// Several outputs that are filled together.
#include "apps/recognition/output_list.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace trivet::apps {
namespace {

/// Records its calls, and fails on request.
class NotingOutput : public Output {
 public:
  NotingOutput(std::string name, std::vector<std::string>& notes, bool adds, bool finishes)
      : name_(std::move(name)), notes_(notes), adds_(adds), finishes_(finishes) {}

  Result<void> add(const RecognizedScene& scene) override {
    notes_.push_back(name_ + " adds " + std::to_string(scene.index));
    return adds_ ? Result<void>() : Error{ErrorCode::io, name_ + " cannot add"};
  }
  void add_failed(const SceneInput&, const Error& error) override {
    notes_.push_back(name_ + " hears: " + error.message);
  }
  Result<void> finish() override {
    notes_.push_back(name_ + " finishes");
    return finishes_ ? Result<void>() : Error{ErrorCode::io, name_ + " cannot finish"};
  }

 private:
  const std::string name_;
  std::vector<std::string>& notes_;
  const bool adds_, finishes_;
};

class OutputsOfACommand : public testing::Test {
 protected:
  void push_back(const std::string& name, bool adds = true, bool finishes = true) {
    outputs_.push_back(std::make_unique<NotingOutput>(name, notes_, adds, finishes));
  }
  void add(std::size_t index) { outputs_.add({index, input_, result_, result_}); }

  const SceneInput input_;
  const SceneResult result_;
  std::vector<std::string> notes_;
  OutputList outputs_;
};

TEST_F(OutputsOfACommand, AreFilledAndFinishedInTheirOrder) {
  push_back("a");
  push_back("b");
  add(0);
  outputs_.add_failed(input_, {ErrorCode::bad_data, "broken"});
  EXPECT_TRUE(outputs_.finish());
  EXPECT_EQ(notes_, (std::vector<std::string>{"a adds 0", "b adds 0", "a hears: broken",
                                              "b hears: broken", "a finishes", "b finishes"}));
}

TEST_F(OutputsOfACommand, FillOthersAndFinishNothingOnceOneCannotAdd) {
  push_back("a", false);
  push_back("b", false);
  push_back("c");
  add(0);
  add(1);
  EXPECT_EQ(outputs_.finish().error().message, "a cannot add");
  EXPECT_EQ(notes_, (std::vector<std::string>{"a adds 0", "b adds 0", "c adds 0", "c adds 1"}));
}

TEST_F(OutputsOfACommand, EndAtTheFirstThatCannotFinish) {
  push_back("a");
  push_back("b", true, false);
  push_back("c");
  EXPECT_EQ(outputs_.finish().error().message, "b cannot finish");
  EXPECT_EQ(notes_, (std::vector<std::string>{"a finishes", "b finishes"}));
}

}  // namespace
}  // namespace trivet::apps
