#pragma once

// The codes of the motion compiler's messages. They are stable: a code that is no longer used is not given to
// another message. docs/reference/motion-language.md explains each. The check has the codes from C001 on.
namespace koboshi::simulation::code {

inline constexpr const char* kYaml = "M001";  // not well-formed YAML
inline constexpr const char* kMissingKey = "M002";
inline constexpr const char* kUnknownKey = "M003";
inline constexpr const char* kBadValue = "M004";  // wrong type, or out of range
inline constexpr const char* kOtherRobot = "M005";
inline constexpr const char* kBadName = "M006";
inline constexpr const char* kBadVersion = "M007";
inline constexpr const char* kNeedsVersion2 = "M008";

inline constexpr const char* kUnknownJoint = "M010";
inline constexpr const char* kSecondAngle = "M011";
inline constexpr const char* kBeyondLimits = "M012";
inline constexpr const char* kUnknownPose = "M013";
inline constexpr const char* kCyclicPoses = "M014";
inline constexpr const char* kJointNotListed = "M015";
inline constexpr const char* kUnreachable = "M016";
inline constexpr const char* kEmptyPose = "M017";
inline constexpr const char* kBadTarget = "M018";  // Cartesian targets that contradict each other

inline constexpr const char* kUnknownStep = "M020";
inline constexpr const char* kUnknownLabel = "M021";
inline constexpr const char* kSecondLabel = "M022";
inline constexpr const char* kUnknownRoutine = "M023";
inline constexpr const char* kRecursion = "M024";
inline constexpr const char* kBadExit = "M025";
inline constexpr const char* kContradiction = "M026";  // keys of a step that exclude each other

inline constexpr const char* kSyntax = "M030";  // syntax of an expression
inline constexpr const char* kUnknownOperand = "M031";
inline constexpr const char* kNotACondition = "M032";  // a condition where a number is expected
inline constexpr const char* kIntegerRange = "M033";
inline constexpr const char* kDivisionByZero = "M034";
inline constexpr const char* kUnknownVariable = "M035";
inline constexpr const char* kTooManyVariables = "M036";

inline constexpr const char* kTooFast = "M040";
inline constexpr const char* kTooMany = "M041";          // poses, steps, groups, levels
inline constexpr const char* kRefused = "M042";          // rejected by the firmware's validator
inline constexpr const char* kUnused = "M050";           // warning
inline constexpr const char* kLeanWithoutLegs = "M051";  // warning
inline constexpr const char* kClamped = "M052";          // warning
inline constexpr const char* kZmpPath = "M053";          // warning

}  // namespace koboshi::simulation::code
