# SPDX-License-Identifier: BSD-3-Clause
"""Two policies that the project did not train for the study, judged as if they were Ours: the
authors' published network and the shipped policy. They have no part in a verdict."""
import json
from dataclasses import dataclass
from pathlib import Path

import claims
import tables
from evidence import Evidence

FOLDER = Path(__file__).resolve().parent.parent / "controls"
AUTHORS = "authors"


@dataclass(frozen=True)
class Control:
    """A file of `controls/`. `rules`: {id of a claim: what it agrees with, its verdict, its
    figures}; `beach`: its cells of Table 1."""
    name: str
    of: dict  # where the figures come from
    beach: list
    rules: dict

    def judgement(self, claim):
        """Its verdict and figures under the rule of this claim; None if it has none, or had another
        rule."""
        found = self.rules.get(claim.id)
        return found[1:] if found and found[0] == claim.agrees_if else None


def read_all():
    """By the name of its file, the authors' network first."""
    return {path.stem: Control(**json.loads(path.read_text())) for path in sorted(FOLDER.glob("*.json"))}


def judged_as_ours(evidence):
    """The evidence with the policy of --published in the place of Ours."""
    measured = {}
    for experiment, controllers in evidence.measured.items():
        measured[experiment] = {c: seeds for c, seeds in controllers.items() if c != "ours"}
        if "published" in controllers:
            measured[experiment]["ours"] = {1: controllers["published"][0]}
    return Evidence(measured, None, competent=("ours",))


def made_of(evidence, results):
    """What a file of `controls/` holds, of the policy of --published; None without it, or without
    its runs on the beach."""
    if not evidence.seeds("E1", "published"):
        return None
    as_ours = judged_as_ours(evidence)
    rules = {}
    for claim in claims.read_claims(claims.CLAIMS_FILE.read_text()):
        rule = claims.RULES.get(claim.id)
        if rule and "ours" in rule.controllers and claims.was_run(rule, as_ours)[0]:
            judgement = claims.judge(claim, as_ours)
            rules[claim.id] = [claim.agrees_if, judgement.verdict + (f" ({judgement.reason})" if judgement.reason else ""),
                               judgement.ours]
    model = results["models"]["published-0"]
    return {"name": model["provenance"].get("name", "published"),
            "of": {"hash": model["hash"], "build": results["build"], "command": results["command"]},
            "beach": tables.beach_cells(evidence, "published"), "rules": rules}


def concern_it_alone(claim):
    """Whether the rule needs no other controller than Ours."""
    return claims.RULES[claim.id].controllers == ["ours"]


def failed_rules(control, judged, alone):
    """The claims whose rule it does not meet, of those that need it alone, or of the others. One
    whose other controllers are not competent tells nothing."""
    found = [(claim, control.judgement(claim)) for claim, _ in judged if claim.id in control.rules]
    return [claim.id for claim, judgement in found
            if judgement and judgement[0] != claims.AGREES and claims.NOT_COMPETENT not in judgement[0] and
            concern_it_alone(claim) == alone]
