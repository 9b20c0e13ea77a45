"""Certificates: written, read, verified, and valid by their schema."""

from __future__ import annotations

import copy
import json
from pathlib import Path

import pytest

import retarget
from optional import need

SOURCE = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def files(data: Path, tmp_path_factory) -> tuple[Path, Path]:
    """A motion and its source."""
    folder = tmp_path_factory.mktemp("certify")
    source = folder / "squat.bvh"
    source.write_bytes((data / "squat.bvh").read_bytes())
    motion = folder / "squat.csv"
    retarget.to_robot(retarget.load(source), "unitree_g1").save(motion)
    return motion, source


@pytest.fixture(scope="module")
def certificate(files) -> retarget.Certificate:
    motion, source = files
    return retarget.certify(motion, "unitree_g1", source)


def test_is_that_of_the_command(files, certificate, command) -> None:
    motion, source = files
    written = motion.with_name("command.json")
    command("certify", motion, "--robot", "unitree_g1", "--bvh", source, "-o", written,
            code=0 if certificate.passed else 1)
    assert written.read_text() == certificate.json
    assert dict(certificate) == json.loads(certificate.json)
    assert not certificate.fell
    assert certificate["quality"]["tracked_pct"] == 100
    assert (certificate.predicted_tracking_success
            == certificate["quality"]["predicted_tracking_success"])
    assert "squat.csv" in repr(certificate)


def test_verify(files, certificate) -> None:
    motion, _ = files
    saved = certificate.save()
    assert saved == motion.with_name("squat.csv.certificate.json")
    assert any("verified" in line for line in retarget.verify(saved))
    forged = copy.deepcopy(certificate.data)
    forged["margins"]["torque"] += 0.01
    other = motion.with_name("forged.json")
    other.write_text(json.dumps(forged))
    with pytest.raises(retarget.RunError, match="/margins/torque"):
        retarget.verify(other)


def test_gates_bound_the_figures_of_certificates(files) -> None:
    motion, _ = files
    strict = retarget.certify(motion, "unitree_g1", gate=["none", "predicted_tracking_success>=1.5"])
    assert not strict.passed and not strict.fell
    assert [gate["metric"] for gate in strict["quality"]["gates"]] == ["predicted_tracking_success"]


def test_wrong_calls(files) -> None:
    motion, _ = files
    with pytest.raises(retarget.UsageError, match="did you mean"):
        retarget.certify(motion, "unitree_g1", limit="official")
    with pytest.raises(FileNotFoundError):
        retarget.certify(motion.with_name("none.csv"), "unitree_g1")
    short = motion.with_name("short.csv")
    short.write_text("\n".join(motion.read_text().splitlines()[:2]) + "\n")
    with pytest.raises(retarget.InputError):
        retarget.certify(short, "unitree_g1")


# Members that may be missing, by their path; all others are required.
def test_schema(certificate) -> None:
    jsonschema = need("jsonschema")
    schema = json.loads((SOURCE / "docs/certificate.schema.json").read_text())
    validator = jsonschema.Draft202012Validator
    validator.check_schema(schema)
    validator(schema).validate(certificate.data)
    broken = [
        (("schema",), "retarget-certificate-0"),
        (("motion", "hash"), "sha256:12"),
        (("prediction", "predicted_tracking_success"), 1.2),
        (("simulation", "fell"), "no"),
        (("margins", "torque"), "high"),
        (("quality", "gates"), {}),
        (("verdict", "passed"), None),
        (("unknown",), 1),
    ]
    for path, value in broken:
        other = copy.deepcopy(certificate.data)
        inner = other
        for key in path[:-1]:
            inner = inner[key]
        inner[path[-1]] = value
        assert not validator(schema).is_valid(other), path
    for key in schema["required"]:
        other = {name: value for name, value in certificate.items() if name != key}
        assert not validator(schema).is_valid(other), key
