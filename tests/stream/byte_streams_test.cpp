// Components for stream bytes: lines, queues, writers, senders.

#include <gtest/gtest.h>
#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#else
#include <unistd.h>
#endif

#include <array>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "live/stream/byte_source.h"
#include "live/stream/message_cutter.h"
#include "live/stream/writer_thread.h"
#include "retarget/os.h"
#include "support/processor_time.h"

namespace retarget {
namespace {

std::vector<std::string> lines_of(LineCutter& cutter) {
  std::vector<std::string> lines;
  for (std::string_view line; cutter.next(line);) lines.emplace_back(line);
  return lines;
}

using Lines = std::vector<std::string>;

TEST(LineCutter, JoinsPiecesToWholeLines) {
  LineCutter cutter(64);
  cutter.add("a\n\n  \nb");
  EXPECT_EQ(lines_of(cutter), (Lines{"a"}));
  cutter.add("c\nd");
  EXPECT_EQ(lines_of(cutter), (Lines{"bc"}));
  cutter.end();
  EXPECT_EQ(lines_of(cutter), (Lines{"d"}));
  EXPECT_EQ(cutter.dropped(), 0);
}

TEST(LineCutter, DropsLinesWithoutAnEnd) {
  LineCutter cutter(64);
  const std::string piece(1000, 'x');
  for (int i = 0; i < 5000; ++i) {
    cutter.add(piece);
    EXPECT_TRUE(lines_of(cutter).empty());
  }
  EXPECT_EQ(cutter.dropped(), 1);
  cutter.add("x\nnext\n");
  EXPECT_EQ(lines_of(cutter), (Lines{"next"}));
  EXPECT_EQ(cutter.dropped(), 1);
}

// A line that arrives byte by byte is scanned once.
TEST(LineCutter, RunsInLinearTime) {
  const auto add_bytes = [](int count) {
    LineCutter cutter(64);
    std::string_view line;
    for (int i = 0; i < count; ++i) {
      cutter.add("x");
      ASSERT_FALSE(cutter.next(line));
    }
  };
  EXPECT_LT(time_growth(add_bytes, 30'000, 300'000), 35) << "10 is linear, 100 quadratic";
}

TEST(LineCutter, BoundsTheLinesOfADatagram) {
  LineCutter cutter(3);
  std::string datagram;
  for (int i = 0; i < 20000; ++i) datagram += "{}\n";
  cutter.add_datagram(datagram);
  EXPECT_EQ(lines_of(cutter).size(), 3U);
  EXPECT_EQ(cutter.dropped(), 1);
  cutter.add_datagram("1\n2\n3");
  EXPECT_EQ(lines_of(cutter), (Lines{"1", "2", "3"}));
}

TEST(FrameBytesQueue, IsBoundedByFramesAndBytes) {
  FrameBytesQueue queue({3, 10});
  EXPECT_TRUE(queue.has_room(100)) << "an empty queue takes any frame";
  queue.push("1234");
  queue.push("5678");
  EXPECT_FALSE(queue.has_room(4));
  ASSERT_TRUE(queue.has_room(2));
  queue.push("90");
  EXPECT_FALSE(queue.has_room(0));
  std::string frame;
  queue.take(frame);
  EXPECT_EQ(frame, "1234");
  queue.drop_oldest();
  queue.take(frame);
  EXPECT_EQ(frame, "90");
  EXPECT_TRUE(queue.empty());
}

class Writer : public testing::Test {
 protected:
  Writer() {
    std::array<int, 2> ends{};
#ifdef _WIN32
    EXPECT_EQ(::_pipe(ends.data(), 1 << 16, _O_BINARY | _O_NOINHERIT), 0);
#else
    EXPECT_EQ(::pipe(ends.data()), 0);
#endif
    reader_ = Descriptor(ends[0]);
    to_ = Descriptor(ends[1]);
  }
  std::string read_all() {
    std::string all;
    std::array<char, 65536> room;
    for (std::int64_t count = 1; count > 0;) {
      count = os::read_bytes(reader_.number(), room.data(), room.size());
      if (count > 0) all.append(room.data(), static_cast<std::size_t>(count));
    }
    return all;
  }
  Descriptor reader_, to_;
  const std::string piece_ = std::string(1000, 'x');
};

TEST_F(Writer, ASleepingReaderDoesNotBlockTheWriter) {
  const auto begin = std::chrono::steady_clock::now();
  int taken = 0;
  {
    WriterThread writer(std::move(to_), {100, 1 << 20});
    for (int i = 0; i < 2000; ++i) taken += writer.put(piece_) ? 1 : 0;
    EXPECT_FALSE(writer.finish(false, {}));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  EXPECT_LT(taken, 400);
  EXPECT_EQ(read_all().size() % piece_.size(), 0U) << "no piece is cut";
}

TEST_F(Writer, CanWaitForASlowReader) {
  std::string all;
  std::thread slow([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    all = read_all();
  });
  {
    WriterThread writer(std::move(to_), {10, 1 << 20});
    for (int i = 0; i < 500; ++i) EXPECT_TRUE(writer.put_in_time(piece_, [] { return false; }));
    EXPECT_TRUE(writer.finish(true, [] { return false; }));
    EXPECT_EQ(writer.progress().written, 500);
  }
  slow.join();
  EXPECT_EQ(all.size(), 500 * piece_.size());
}

TEST_F(Writer, StopsWaitingWhenStopped) {
  WriterThread writer(std::move(to_), {200, 1 << 20});
  // More than a pipe buffer.
  for (int i = 0; i < 200; ++i) EXPECT_TRUE(writer.put(piece_));
  const auto stopped = [] { return true; };
  EXPECT_FALSE(writer.put_in_time(std::string(1 << 20, 'x'), stopped));
  EXPECT_FALSE(writer.finish(true, stopped));
}

TEST_F(Writer, ClosedReaderIsAnError) {
  reader_.close();
  WriterThread writer(std::move(to_), {10, 1 << 20});
  EXPECT_TRUE(writer.put(piece_));
  EXPECT_FALSE(writer.finish(false, {}));
  EXPECT_EQ(writer.progress().error, EPIPE);
  EXPECT_FALSE(writer.put(piece_));
}

class Senders : public testing::Test {
 protected:
  using Verdict = SenderLock::Verdict;
  static Endpoint at(std::uint32_t host, std::uint16_t port) { return {host, port}; }
};

TEST_F(Senders, FollowTheFirstOneUntilItIsSilent) {
  SenderLock lock;
  EXPECT_EQ(lock.judge(at(1, 5), 0.0), Verdict::kSender);
  EXPECT_EQ(lock.judge(at(1, 5), 0.1), Verdict::kSender);
  EXPECT_EQ(lock.judge(at(1, 6), 0.2), Verdict::kStranger);
  EXPECT_EQ(lock.judge(at(2, 5), 1.0), Verdict::kStranger);
  EXPECT_EQ(lock.judge(at(2, 5), 1.2), Verdict::kNewSender);
  EXPECT_EQ(lock.judge(at(1, 5), 1.3), Verdict::kStranger);
  EXPECT_EQ(lock.judge(at(2, 9), 2.5), Verdict::kSender) << "the same machine";
}

TEST_F(Senders, AreNotReplacedAfterAStallOfTheReceiver) {
  SenderLock lock;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(lock.judge(at(1, 5), 0.1 * i), Verdict::kSender);
  EXPECT_EQ(lock.judge(at(2, 5), 3.0, 0.95), Verdict::kStranger);
  EXPECT_EQ(lock.judge(at(1, 5), 3.0, 0.95), Verdict::kSender);
  EXPECT_EQ(lock.judge(at(2, 5), 4.1, 4.1), Verdict::kNewSender);
}

TEST_F(Senders, APortForEveryDatagramIsOneSender) {
  SenderLock lock;
  for (std::uint16_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(lock.judge(at(1, i), 0.01 * i), Verdict::kSender);
    EXPECT_EQ(lock.judge(at(2, i), 0.01 * i), Verdict::kStranger);
  }
}

// Ports are drawn at random: some datagrams have the port of one of the latest eight.
TEST_F(Senders, APortForEveryDatagramMayRepeat) {
  SenderLock lock;
  for (std::uint16_t i = 0; i < 1000; ++i) {
    const auto back = static_cast<std::uint16_t>(i % 50 == 40 ? 1 + i / 50 % 8 : 0);
    EXPECT_EQ(lock.judge(at(1, i - back), 0.01 * i), Verdict::kSender) << i;
  }
}

TEST_F(Senders, FollowOneOfTwoProgramsOnAMachine) {
  SenderLock lock;
  int first = 0, second = 0;
  for (int i = 0; i < 100; ++i) {
    first += lock.judge(at(1, 5), 0.02 * i) == Verdict::kSender ? 1 : 0;
    second += lock.judge(at(1, 6), 0.02 * i + 0.01) == Verdict::kSender ? 1 : 0;
  }
  EXPECT_EQ(first, 100);
  EXPECT_EQ(second, 1);
}

// Its packets are those of another program, with another skeleton.
TEST_F(Senders, AProgramThatRestartsIsANewSender) {
  SenderLock lock;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(lock.judge(at(1, 5), 0.1 * i), Verdict::kSender);
  EXPECT_EQ(lock.judge(at(1, 6), 1.2), Verdict::kStranger);
  EXPECT_EQ(lock.judge(at(1, 6), 2.0), Verdict::kNewSender);
  EXPECT_EQ(lock.judge(at(1, 6), 2.1), Verdict::kSender);
}

TEST_F(Senders, StrangersLeaveTheirFirstDatagrams) {
  EarlyDatagrams early;
  for (int i = 0; i < 100; ++i) early.keep(at(1, 6), "skeleton " + std::to_string(i), 0.01 * i);
  early.keep(at(2, 6), "other", 0.5);
  EXPECT_EQ(early.take(at(1, 6)), (Lines{"skeleton 0", "skeleton 1", "skeleton 2", "skeleton 3"}));
  EXPECT_TRUE(early.take(at(1, 6)).empty());
  // A flood from many addresses takes no memory; the latest are kept.
  for (std::uint16_t i = 0; i < 1000; ++i) early.keep(at(3, i), "flood", 1.0 + i);
  EXPECT_TRUE(early.take(at(2, 6)).empty());
  EXPECT_EQ(early.take(at(3, 999)), (Lines{"flood"}));
  EXPECT_TRUE(early.take(at(3, 0)).empty());
}

TEST_F(Senders, AcceptsOnlyPermittedSenders) {
  SenderLock lock(SenderFilter::parse("10.0.0.2").value());
  EXPECT_EQ(lock.judge(at(0x0A000003, 5), 0.0), Verdict::kStranger);
  EXPECT_EQ(lock.judge(at(0x0A000002, 5), 0.0), Verdict::kSender);
  SenderLock with_port(SenderFilter::parse("10.0.0.2:7").value());
  EXPECT_EQ(with_port.judge(at(0x0A000002, 5), 0.0), Verdict::kStranger);
  EXPECT_EQ(with_port.judge(at(0x0A000002, 7), 0.0), Verdict::kSender);
  SenderLock everybody(SenderFilter::parse("any").value());
  EXPECT_EQ(everybody.judge(at(1, 1), 0.0), Verdict::kSender);
  EXPECT_EQ(everybody.judge(at(2, 2), 0.0), Verdict::kSender);
  for (const char* bad : {"motive", "10.0.0", "10.0.0.2:", "10.0.0.2:0", "10.0.0.2:99999", ":7"}) {
    EXPECT_FALSE(SenderFilter::parse(bad)) << bad;
  }
}

TEST_F(Senders, AServerMaySendFromSeveralPorts) {
  SenderLock lock({}, true);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(lock.judge(at(1, 1510), 0.02 * i), Verdict::kSender);
    EXPECT_EQ(lock.judge(at(1, 1511), 0.02 * i), Verdict::kSender);
    EXPECT_EQ(lock.judge(at(2, 1511), 0.02 * i), Verdict::kStranger);
  }
}

}  // namespace
}  // namespace retarget
