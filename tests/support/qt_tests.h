#pragma once

#include <QByteArray>
#include <QMetaObject>
#include <QObject>
#include <QTest>
#include <algorithm>
#include <memory>
#include <vector>

namespace koboshi::test {

// A class of tests in a program of several, which share the start of the program.
struct QtTest {
  const QMetaObject* meta;
  std::unique_ptr<QObject> (*make)();

  bool has(const char* argument) const {
    return meta->indexOfMethod(QByteArray(argument).split(':').front() + "()") >= 0;
  }
};

inline std::vector<QtTest>& qt_tests() {
  static std::vector<QtTest> tests;
  return tests;
}

// Adds a class to the tests of the program: a variable in the source file of the class.
template <typename Test>
struct AddQtTest {
  AddQtTest() {
    qt_tests().push_back({&Test::staticMetaObject, [] { return std::unique_ptr<QObject>(new Test); }});
  }
};

// Runs the added tests. An argument that names a function is for the classes that have it; the others do not
// run then. Returns the number of failures.
inline int run_qt_tests(int argc, char** argv) {
  const std::vector<char*> arguments(argv + 1, argv + argc);
  const auto is_function = [](const char* argument) {
    return std::ranges::any_of(qt_tests(), [&](const QtTest& test) { return test.has(argument); });
  };
  const bool chooses = std::ranges::any_of(arguments, is_function);
  int failures = 0;
  for (const QtTest& test : qt_tests()) {
    std::vector<char*> own{argv[0]};
    for (char* argument : arguments)
      if (!is_function(argument) || test.has(argument)) own.push_back(argument);
    const bool is_chosen = std::ranges::any_of(own, [&](const char* argument) { return test.has(argument); });
    if (chooses && !is_chosen) continue;
    failures += QTest::qExec(test.make().get(), static_cast<int>(own.size()), own.data());
  }
  return failures;
}

}  // namespace koboshi::test
