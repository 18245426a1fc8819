"""What a reading of a robot finds: each finding names the file, the element and what would be right."""

from __future__ import annotations

from dataclasses import dataclass, field

from stepover.errors import InvalidInput

ERROR, WARNING, NOTE = "error", "warning", "note"
"""An error ends in a refusal; a warning may spoil results; a note says what was left out or repaired."""


@dataclass(frozen=True)
class Finding:
    """One finding.

    Attributes:
        severity: ERROR, WARNING or NOTE.
        where: file and element.
        what: what is there, and what would be right.
    """

    severity: str
    where: str
    what: str

    def __str__(self) -> str:
        """One line."""
        return f"{self.where}: {self.what}"


@dataclass
class Findings:
    """All findings of a reading, in their order."""

    file: str
    found: list[Finding] = field(default_factory=list)

    def error(self, element: str, what: str) -> None:
        """Something that makes the robot unusable."""
        self._add(ERROR, element, what)

    def note(self, element: str, what: str) -> None:
        """Something that was left out or repaired."""
        self._add(NOTE, element, what)

    def _add(self, severity: str, element: str, what: str) -> None:
        """Keep a finding, once."""
        finding = Finding(severity, f"{self.file}: {element}" if element else self.file, what)
        if finding not in self.found:
            self.found.append(finding)

    def require(self) -> None:
        """Refuse the robot where there is an error.

        Raises:
            InvalidInput: the first error, and how many more there are.
        """
        errors = [finding for finding in self.found if finding.severity == ERROR]
        if errors:
            more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
            raise InvalidInput(f"{errors[0]}{more}")
