/// The queue of the service: which jobs are accepted, refused, stopped and answered, and with which
/// library.
#include "engine/recognition/recognition_service.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <latch>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "engine/loaded_library/recognizer.hpp"

namespace trivet {
namespace {

using std::chrono::milliseconds;

std::shared_ptr<const LibraryGeneration> generation(std::uint64_t number) {
  return std::make_shared<LibraryGeneration>(LibraryGeneration{Recognizer(Library{}), number});
}

using Work = std::function<Result<void>(std::size_t, const LibraryGeneration&, std::stop_token)>;

ServiceJob job(Work work, std::size_t num_parts = 1) {
  ServiceJob out;
  out.num_parts = num_parts;
  out.work = std::move(work);
  return out;
}

/// The outcome of a job.
std::future<ServiceOutcome> submit(RecognitionService& service, ServiceJob job) {
  auto promise = std::make_shared<std::promise<ServiceOutcome>>();
  std::future<ServiceOutcome> outcome = promise->get_future();
  service.submit(std::move(job),
                 [promise](ServiceOutcome out) { promise->set_value(std::move(out)); });
  return outcome;
}

Refusal refusal_of(std::future<ServiceOutcome> outcome) {
  const ServiceOutcome out = outcome.get();
  EXPECT_TRUE(std::holds_alternative<Refusal>(out));
  return std::get<Refusal>(out);
}

Result<void> nothing(std::size_t, const LibraryGeneration&, const std::stop_token&) { return {}; }

/// Blocks workers until it is opened.
struct Gate {
  std::latch opened{1};
  std::latch reached;
  explicit Gate(std::ptrdiff_t num_workers) : reached(num_workers) {}
  Work work() {
    return [this](std::size_t, const LibraryGeneration&, const std::stop_token&) -> Result<void> {
      reached.count_down();
      opened.wait();
      return {};
    };
  }
};

void wait_until_stopped(const std::stop_token& stop) {
  while (!stop.stop_requested()) std::this_thread::sleep_for(milliseconds(1));
}

TEST(RecognitionService, DoesEachPartOnceAndAnswersOnce) {
  RecognitionService service({.num_parallel = 3}, generation(1));
  std::vector<std::atomic<int>> done(50);
  const auto outcome = submit(service, job(
                                           [&](std::size_t part, const LibraryGeneration& library,
                                               const std::stop_token&) -> Result<void> {
                                             EXPECT_EQ(library.number, 1U);
                                             ++done[part];
                                             return {};
                                           },
                                           done.size()))
                           .get();
  ASSERT_TRUE(std::holds_alternative<ServiceAnswer>(outcome));
  EXPECT_EQ(std::get<ServiceAnswer>(outcome).generation->number, 1U);
  for (const std::atomic<int>& n : done) EXPECT_EQ(n, 1);
}

TEST(RecognitionService, AcceptsAllPartsOfAJobOrNone) {
  RecognitionService service({.max_waiting = 4, .num_parallel = 1}, generation(1));
  Gate gate(1);
  auto running = submit(service, job(gate.work()));
  gate.reached.wait();
  auto waiting = submit(service, job(nothing, 3));
  EXPECT_EQ(refusal_of(submit(service, job(nothing, 2))), Refusal::full);
  EXPECT_EQ(service.state().num_waiting, 3U) << "no part of what was refused";
  auto last = submit(service, job(nothing));
  EXPECT_TRUE(service.is_full(0));
  const ServiceOutcome too_many = submit(service, job(nothing, 5)).get();
  ASSERT_TRUE(std::holds_alternative<Error>(too_many));
  EXPECT_EQ(std::get<Error>(too_many).code, ErrorCode::usage);
  gate.opened.count_down();
  for (auto* const outcome : {&running, &waiting, &last})
    EXPECT_TRUE(std::holds_alternative<ServiceAnswer>(outcome->get()));
}

TEST(RecognitionService, CountsTheBytesOfWhatItHolds) {
  RecognitionService service({.max_waiting_bytes = 100, .num_parallel = 1}, generation(1));
  Gate gate(1);
  ServiceJob large = job(gate.work(), 2);
  large.num_bytes = 70;
  auto outcome = submit(service, std::move(large));
  gate.reached.wait();
  EXPECT_EQ(service.state().num_bytes, 70U) << "once, whatever the number of parts";
  EXPECT_TRUE(service.is_full(31));
  EXPECT_FALSE(service.is_full(30));
  ServiceJob more = job(nothing);
  more.num_bytes = 31;
  EXPECT_EQ(refusal_of(submit(service, std::move(more))), Refusal::full);
  gate.opened.count_down();
  (void)outcome.get();
  EXPECT_TRUE(service.drain(ServiceClock::now() + std::chrono::seconds(60)));
  EXPECT_EQ(service.state().num_bytes, 0U);
}

TEST(RecognitionService, RefusesInTheQueueWhatItsDeadlineOvertakes) {
  RecognitionService service({.num_parallel = 1}, generation(1));
  Gate gate(1);
  auto running = submit(service, job(gate.work()));
  gate.reached.wait();
  std::atomic<bool> was_begun{false};
  ServiceJob late = job([&](std::size_t, const LibraryGeneration&, const std::stop_token&) {
    was_begun = true;
    return Result<void>();
  });
  late.deadline = ServiceClock::now() + milliseconds(50);
  // The deadline passes before the job starts, because the only worker is busy.
  EXPECT_EQ(refusal_of(submit(service, std::move(late))), Refusal::too_late);
  ServiceJob passed = job(nothing);
  passed.deadline = ServiceClock::now();
  EXPECT_EQ(refusal_of(submit(service, std::move(passed))), Refusal::too_late);
  gate.opened.count_down();
  (void)running.get();
  EXPECT_FALSE(was_begun);
}

TEST(RecognitionService, RefusesWhatItCouldNotAnswerInTime) {
  RecognitionService service({.num_parallel = 1}, generation(1));
  // A part takes a tenth of a second.
  (void)submit(service, job([](std::size_t, const LibraryGeneration&, const std::stop_token&) {
                 std::this_thread::sleep_for(milliseconds(100));
                 return Result<void>();
               }))
      .get();
  Gate gate(1);
  auto running = submit(service, job(gate.work()));
  gate.reached.wait();
  const auto with_deadline = [&](int ms, std::size_t num_parts) {
    ServiceJob out = job(nothing, num_parts);
    out.deadline = ServiceClock::now() + milliseconds(ms);
    return submit(service, std::move(out));
  };
  auto patient = with_deadline(60'000, 20);
  EXPECT_EQ(refusal_of(with_deadline(1000, 1)), Refusal::full) << "twenty wait before it";
  EXPECT_EQ(service.state().num_waiting, 20U);
  gate.opened.count_down();
  EXPECT_TRUE(std::holds_alternative<ServiceAnswer>(patient.get()));
  (void)running.get();
  // With a free worker the job is tried, whatever the mean duration.
  while (service.state().num_running > 0) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_TRUE(std::holds_alternative<ServiceAnswer>(with_deadline(10, 1).get()));
}

TEST(RecognitionService, StopsWhatNobodyWaitsForAnyMore) {
  RecognitionService service({.num_parallel = 2}, generation(1));
  std::atomic<bool> is_gone{false};
  std::latch begun(2);
  ServiceJob left = job(
      [&](std::size_t, const LibraryGeneration&, const std::stop_token& stop) -> Result<void> {
        begun.count_down();
        wait_until_stopped(stop);
        return {};
      },
      2);
  left.is_gone = [&] { return is_gone.load(); };
  auto outcome = submit(service, std::move(left));
  begun.wait();
  is_gone = true;
  EXPECT_EQ(refusal_of(std::move(outcome)), Refusal::gone);
}

TEST(RecognitionService, StopsTheOtherPartsOfAJobThatFails) {
  RecognitionService service({.num_parallel = 2}, generation(1));
  std::atomic<int> num_begun{0};
  const ServiceOutcome outcome =
      submit(service, job(
                          [&](std::size_t part, const LibraryGeneration&,
                              const std::stop_token& stop) -> Result<void> {
                            ++num_begun;
                            if (part == 0) return Error{ErrorCode::bad_data, "part 0 is broken"};
                            wait_until_stopped(stop);
                            return {};
                          },
                          10))
          .get();
  ASSERT_TRUE(std::holds_alternative<Error>(outcome));
  EXPECT_EQ(std::get<Error>(outcome).message, "part 0 is broken");
  EXPECT_LE(num_begun, 2);
}

TEST(RecognitionService, SurvivesWorkThatThrows) {
  RecognitionService service({.num_parallel = 1}, generation(1));
  const ServiceOutcome outcome =
      submit(service,
             job([](std::size_t, const LibraryGeneration&, const std::stop_token&) -> Result<void> {
               throw std::runtime_error("thrown");
             }))
          .get();
  ASSERT_TRUE(std::holds_alternative<Error>(outcome));
  EXPECT_EQ(std::get<Error>(outcome).code, ErrorCode::internal);
  EXPECT_TRUE(std::holds_alternative<ServiceAnswer>(submit(service, job(nothing)).get()));
}

TEST(RecognitionService, AnswersWithTheLibraryThatThereWasAndLetsItGo) {
  auto first = generation(1);
  const std::weak_ptr<const LibraryGeneration> watched = first;
  RecognitionService service({.num_parallel = 1}, std::move(first));
  Gate gate(1);
  auto running = submit(service, job(gate.work()));
  gate.reached.wait();
  std::atomic<std::uint64_t> library_number{0};
  auto waiting = submit(service, job([&](std::size_t, const LibraryGeneration& library,
                                         const std::stop_token&) -> Result<void> {
                          library_number = library.number;
                          return {};
                        }));
  service.publish(generation(2));
  gate.opened.count_down();
  EXPECT_EQ(std::get<ServiceAnswer>(running.get()).generation->number, 1U);
  EXPECT_EQ(std::get<ServiceAnswer>(waiting.get()).generation->number, 1U);
  EXPECT_EQ(library_number, 1U) << "taken before the new one was there";
  EXPECT_EQ(std::get<ServiceAnswer>(submit(service, job(nothing)).get()).generation->number, 2U);
  EXPECT_TRUE(service.drain(ServiceClock::now() + std::chrono::seconds(60)));
  EXPECT_TRUE(watched.expired()) << "its memory goes with the last of its answers";
}

TEST(RecognitionService, AnswersAcceptedJobsBeforeItCloses) {
  RecognitionService service({.max_waiting = 100'000, .num_parallel = 1}, generation(1));
  Gate gate(1);
  std::vector<std::future<ServiceOutcome>> outcomes;
  outcomes.push_back(submit(service, job(gate.work())));
  gate.reached.wait();
  for (int i = 0; i < 5; ++i) outcomes.push_back(submit(service, job(nothing)));
  std::thread opener([&] {
    // Jobs submitted after draining begins are refused; earlier ones are answered.
    for (bool is_closed = false; !is_closed;) {
      auto outcome = submit(service, job(nothing));
      is_closed = outcome.wait_for(milliseconds(1)) == std::future_status::ready &&
                  std::holds_alternative<Refusal>(outcome.get());
    }
    gate.opened.count_down();
  });
  EXPECT_TRUE(service.drain(ServiceClock::now() + std::chrono::seconds(60)));
  opener.join();
  for (auto& outcome : outcomes) EXPECT_TRUE(std::holds_alternative<ServiceAnswer>(outcome.get()));
}

TEST(RecognitionService, EndsAtTheDeadlineOfItsDrain) {
  RecognitionService service({.num_parallel = 1}, generation(1));
  std::latch begun(1);
  auto running = submit(service, job([&](std::size_t, const LibraryGeneration&,
                                         const std::stop_token& stop) -> Result<void> {
                          begun.count_down();
                          wait_until_stopped(stop);
                          return {};
                        }));
  begun.wait();
  auto waiting = submit(service, job(nothing));
  EXPECT_FALSE(service.drain(ServiceClock::now() + milliseconds(20)));
  EXPECT_EQ(refusal_of(std::move(running)), Refusal::closed);
  EXPECT_EQ(refusal_of(std::move(waiting)), Refusal::closed);
}

TEST(RecognitionService, AnswersAtTheDeadlineThoughThePartGoesOn) {
  auto first = generation(1);
  const std::weak_ptr<const LibraryGeneration> watched = first;
  RecognitionService service({.num_parallel = 1}, std::move(first));
  service.publish(generation(2));
  EXPECT_TRUE(watched.expired());
  const std::weak_ptr<const LibraryGeneration> second = service.generation();
  Gate gate(1);
  auto held = std::make_shared<int>(7);
  const std::weak_ptr<int> memory = held;
  ServiceJob unresponsive = job([&gate, held](std::size_t, const LibraryGeneration& library,
                                              const std::stop_token&) -> Result<void> {
    gate.reached.count_down();
    gate.opened.wait();
    EXPECT_EQ(*held, 7) << "what the job holds lives as long as it is worked on";
    EXPECT_EQ(library.number, 2U);
    return {};
  });
  held.reset();
  unresponsive.num_bytes = 100;
  unresponsive.deadline = ServiceClock::now() + milliseconds(1000);
  std::atomic<int> num_answers{0};
  std::promise<ServiceOutcome> promise;
  service.submit(std::move(unresponsive), [&](ServiceOutcome out) {
    if (num_answers++ == 0) promise.set_value(std::move(out));
  });
  gate.reached.wait();
  service.publish(generation(3));
  EXPECT_EQ(refusal_of(promise.get_future()), Refusal::too_late) << "the gate is closed still";
  EXPECT_EQ(service.state().num_running, 1U) << "its worker is busy";
  EXPECT_EQ(service.state().num_bytes, 100U);
  EXPECT_FALSE(second.expired());
  EXPECT_FALSE(memory.expired());
  // Another request waits for the worker, and is also answered in time.
  ServiceJob next = job(nothing);
  next.deadline = ServiceClock::now() + milliseconds(50);
  EXPECT_EQ(refusal_of(submit(service, std::move(next))), Refusal::too_late);
  gate.opened.count_down();
  EXPECT_TRUE(service.drain(ServiceClock::now() + std::chrono::seconds(60)));
  EXPECT_EQ(num_answers, 1);
  EXPECT_EQ(service.state().num_bytes, 0U);
  EXPECT_TRUE(second.expired());
  EXPECT_TRUE(memory.expired());
}

TEST(RecognitionService, AnswersForPartsThatGoOnWhoeverHasLeftOrFailed) {
  RecognitionService service({.num_parallel = 2}, generation(1));
  Gate gate(2);
  std::atomic<bool> is_gone{false};
  ServiceJob left = job(gate.work());
  left.is_gone = [&] { return is_gone.load(); };
  auto leaving = submit(service, std::move(left));
  auto failing =
      submit(service, job(
                          [&](std::size_t part, const LibraryGeneration&, const std::stop_token&) {
                            if (part == 0) return Result<void>();
                            return Result<void>(Error{ErrorCode::bad_data, "part 1 is broken"});
                          },
                          2));
  const ServiceOutcome failed = failing.get();
  ASSERT_TRUE(std::holds_alternative<Error>(failed));
  auto unresponsive = submit(service, job(gate.work()));
  gate.reached.wait();
  is_gone = true;
  EXPECT_EQ(refusal_of(std::move(leaving)), Refusal::gone);
  std::thread drain([&] { EXPECT_FALSE(service.drain(ServiceClock::now() + milliseconds(20))); });
  EXPECT_EQ(refusal_of(std::move(unresponsive)), Refusal::closed);
  EXPECT_EQ(service.state().num_running, 2U);
  gate.opened.count_down();
  drain.join();
}

TEST(RecognitionService, ReportsAWorkerThatIgnoresStopRequests) {
  RecognitionService service({.num_parallel = 2}, generation(1));
  Gate gate(1);
  std::atomic<bool> is_gone{false};
  ServiceJob unresponsive = job(gate.work());
  unresponsive.is_gone = [&] { return is_gone.load(); };
  auto leaving = submit(service, std::move(unresponsive));
  gate.reached.wait();
  is_gone = true;
  EXPECT_EQ(refusal_of(std::move(leaving)), Refusal::gone);
  EXPECT_FALSE(service.state().is_stuck) << "work may take a moment to hear";
  for (int i = 0; i < 6000 && !service.state().is_stuck; ++i)
    std::this_thread::sleep_for(milliseconds(10));
  EXPECT_TRUE(service.state().is_stuck);
  EXPECT_TRUE(std::holds_alternative<ServiceAnswer>(submit(service, job(nothing)).get()))
      << "the other worker goes on";
  gate.opened.count_down();
  for (int i = 0; i < 6000 && service.state().is_stuck; ++i)
    std::this_thread::sleep_for(milliseconds(10));
  EXPECT_FALSE(service.state().is_stuck);
}

TEST(RecognitionService, BeginsWhatFitsIntoItsMemory) {
  RecognitionService service({.max_working_bytes = 100, .num_parallel = 3}, generation(1));
  const auto needing = [](Work work, std::size_t part_bytes, std::size_t num_parts = 1) {
    ServiceJob out = job(std::move(work), num_parts);
    out.part_bytes = part_bytes;
    return out;
  };
  EXPECT_EQ(refusal_of(submit(service, needing(nothing, 101))), Refusal::too_large);
  Gate gate(1);
  auto running = submit(service, needing(gate.work(), 60));
  gate.reached.wait();
  std::atomic<std::size_t> most{0};
  auto waiting = submit(
      service,
      needing(
          [&](std::size_t, const LibraryGeneration&, const std::stop_token&) -> Result<void> {
            const std::size_t now = service.state().num_working_bytes;
            std::size_t before = most;
            while (before < now && !most.compare_exchange_weak(before, now)) {
            }
            return {};
          },
          50, 40));
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(service.state().num_waiting, 40U) << "two workers are free, but not 50 bytes";
  EXPECT_EQ(service.state().num_working_bytes, 60U);
  gate.opened.count_down();
  EXPECT_TRUE(std::holds_alternative<ServiceAnswer>(running.get()));
  EXPECT_TRUE(std::holds_alternative<ServiceAnswer>(waiting.get()));
  EXPECT_LE(most, 100U);
  EXPECT_TRUE(service.drain(ServiceClock::now() + std::chrono::seconds(60)));
  EXPECT_EQ(service.state().num_working_bytes, 0U);
}

TEST(RecognitionService, ConcludesOnceAndInTime) {
  RecognitionService service({.num_parallel = 3}, generation(1));
  std::atomic<int> num_done{0}, num_concluded{0};
  ServiceJob good = job(
      [&](std::size_t, const LibraryGeneration&, const std::stop_token&) {
        ++num_done;
        return Result<void>();
      },
      20);
  good.conclude = [&](const ServiceAnswer& answer) {
    EXPECT_EQ(num_done, 20);
    EXPECT_EQ(answer.generation->number, 1U);
    ++num_concluded;
  };
  EXPECT_TRUE(std::holds_alternative<ServiceAnswer>(submit(service, std::move(good)).get()));
  EXPECT_EQ(num_concluded, 1);
  std::latch opened(1);
  ServiceJob slow = job(nothing);
  slow.conclude = [&](const ServiceAnswer&) { opened.wait(); };
  slow.deadline = ServiceClock::now() + milliseconds(100);
  EXPECT_EQ(refusal_of(submit(service, std::move(slow))), Refusal::too_late);
  opened.count_down();
  ServiceJob broken = job(nothing);
  broken.conclude = [](const ServiceAnswer&) { throw std::runtime_error("no words"); };
  EXPECT_TRUE(std::holds_alternative<Error>(submit(service, std::move(broken)).get()));
}

TEST(RecognitionService, NamesAWantOfMemoryAndAnswersInSpiteOfIt) {
  RecognitionService service({.num_parallel = 1}, generation(1));
  EXPECT_EQ(refusal_of(submit(service, job([](std::size_t, const LibraryGeneration&,
                                              const std::stop_token&) -> Result<void> {
                                throw std::bad_alloc();
                              }))),
            Refusal::no_memory);
  std::promise<ServiceOutcome> promise;
  service.submit(job(nothing), [&, tries = 0](ServiceOutcome out) mutable {
    if (++tries < 3) throw std::bad_alloc();
    promise.set_value(std::move(out));
  });
  EXPECT_EQ(refusal_of(promise.get_future()), Refusal::no_memory);
}

}  // namespace
}  // namespace trivet
