"""The page of statistics of a data set."""

from __future__ import annotations

import json
import random
import re
from pathlib import Path

import pytest

import retarget
from optional import need
from retarget.data_set.__main__ import main
from retarget.data_set.duplicates import find_groups
from retarget.data_set.page import write_page
from retarget.data_set.results import read_results


def cells(page: str, head: str) -> list[list[str]]:
    """Returns the rows of the first table after a heading."""
    table = page[page.index(head):].split("</table>")[0]
    return [[re.sub(r"<[^>]*>", "", cell) for cell in re.findall(r"<t[dh].*?</t[dh]>", row)]
            for row in table.split("<tr>")[1:]]


def line(number: int, **changes: object) -> str:
    chance = random.Random(number)
    missed = ["jumps"] if number % 10 == 0 else []
    return json.dumps({
        "relative": f"source{number % 40}/<clip>_{number:06d}.bvh", "robot": "unitree_g1",
        "status": "done", "frames": chance.randint(30, 600), "fps": 30.0, "seconds": 0.1,
        "quality": {"figures": {"peak_speed": chance.uniform(1, 20), "contact_pct": 60.0},
                    "gates_missed": missed, "worst": "jumps" if missed else None,
                    **({"worst_ratio": 1.0 + chance.random()} if missed else {})},
        **changes}) + "\n"


def test_counts(tmp_path: Path) -> None:
    failed = {"status": "failed", "error": {"message": 'no joint "Hips" in line 7'}}
    repeated = {"status": "duplicate", "repeats": {"of": "a.bvh", "distance_deg": 1.25}}
    (tmp_path / "manifest.jsonl").write_text("".join([
        *(line(number) for number in range(100)), line(100, **failed), line(101, **repeated),
        line(1, quality={"figures": {}, "gates_missed": ["jumps", "hover_pct"], "worst": "jumps"}),
        '{"relative": "trunc']))
    page = write_page(tmp_path, tmp_path / "page.html").read_text()
    totals = {row[0]: row[1] for row in cells(page, "<h1>")}
    assert totals["all"] == "102" and totals["passed"] == "89"
    assert (totals["miss a gate"], totals["failed"]) == ("11", "1")
    sources = cells(page, "missed gates by source")
    assert sources[0][:6] == ["source", "clips", "passed", "failed", "jumps", "hover_pct"]
    assert sources[-1] == ["all", "102", "89", "1", "11", "1"]
    assert len(sources) == 32 and "10 smaller sources" in page
    assert cells(page, "<h2>Errors")[1] == ["no joint … in line …", "1"]
    assert cells(page, "Repeated clips: 1")[1][1:] == ["a.bvh", "1.25"]
    worst = cells(page, "<h2>Worst")
    assert worst[1][0] == "source1/&lt;clip&gt;_000001.bvh" and worst[1][2] == "∞"
    assert "<clip>" not in page and "<script" not in page and "http" not in page
    assert len(cells(page, "<h2>Sample")) == 51
    with pytest.raises(retarget.InputError, match="manifest"):
        write_page(tmp_path / "none", tmp_path / "page.html")


def test_a_hundred_thousand_clips(tmp_path: Path) -> None:
    with (tmp_path / "manifest.jsonl").open("w") as manifest:
        manifest.writelines(line(number) for number in range(100_000))
    assert main([str(tmp_path), str(tmp_path / "page.html")]) == 0
    assert (tmp_path / "page.html").stat().st_size < 200_000
    first = (tmp_path / "page.html").read_bytes()
    assert cells(first.decode(), "<h1>")[1][1] == "100,000"
    write_page(tmp_path, tmp_path / "page.html")
    assert (tmp_path / "page.html").read_bytes() == first


def test_both_manifests_agree(data: Path, tmp_path: Path) -> None:
    need("pyarrow")
    from retarget.data_set import run, solve
    from retarget.data_set.inputs import find_clips

    (tmp_path / "in/a").mkdir(parents=True)
    for name in ("squat", "wave", "get_up"):
        (tmp_path / f"in/a/{name}.bvh").write_bytes((data / f"{name}.bvh").read_bytes())
    options = {"gate": "peak_speed<=2"}
    retarget.batch(tmp_path / "in", tmp_path / "batch", "g1", jobs=1, **options)
    request = solve.Request(str(tmp_path / "out"), "g1", options, "", {})
    progress = run.Progress(request, find_clips(tmp_path / "in"), 3, False)
    for task in progress.tasks(16):
        progress.record(solve.solve_clips(request, task, "work"))
    progress.manifest.flush()
    of_batch, of_parts = read_results(tmp_path / "batch"), read_results(tmp_path / "out")
    assert [result.name for result in of_batch] == ["a/get_up.bvh", "a/squat.bvh", "a/wave.bvh"]
    for one, other in zip(of_batch, of_parts, strict=True):
        one.seconds = other.seconds
        assert one == other and one.worst


def test_near_duplicates(data: Path, command, tmp_path: Path) -> None:
    walk = retarget.load(data / "walk.bvh")
    copies = {"a/walk": walk, "b/turned": retarget.edit.turn(walk, 70.0),
              "b/mirrored": retarget.edit.mirror(walk),
              "c/part": retarget.edit.trim(walk, start=0.1, end=9.9),
              "c/squat": retarget.load(data / "squat.bvh")}
    for name, clip in copies.items():
        (tmp_path / f"in/{name}.bvh").parent.mkdir(parents=True, exist_ok=True)
        clip.save(tmp_path / f"in/{name}.bvh")
    retarget.batch(tmp_path / "in", tmp_path / "out", "g1", jobs=1, quality=False)
    group, = find_groups(read_results(str(tmp_path / "out")))
    assert group.first.name == "a/walk.bvh" and group.mirrored == 1 and group.sources == 3
    assert [each.name for each in group.repeats] == ["b/mirrored.bvh", "b/turned.bvh", "c/part.bvh"]
    page = write_page(tmp_path / "out", tmp_path / "page.html").read_text()
    assert cells(page, "Near duplicates: 3 of 5 clips") == [
        ["source", "clips", "repeats"], ["b", "2", "2"], ["c", "2", "1"]]
    row = cells(page, ">repeated clip<")[0]
    assert row[:5] == ["a/walk.bvh", "b/mirrored.bvh", "3", "1", "3"] and 0 < float(row[5]) < 2.5
    # The command finds the same ones.
    command("batch", tmp_path / "in", "-o", tmp_path / "deduped", "--robot", "g1", "--dedupe",
            "--jobs", 1)
    listed = (tmp_path / "deduped/duplicates.tsv").read_text().splitlines()[1:]
    assert {line.split("\t")[0] for line in listed} == {each.name for each in group.repeats}

    assert main([str(tmp_path / "out"), str(tmp_path / "page.html"), "--no-near-duplicates"]) == 0
    assert "Near duplicates" not in (tmp_path / "page.html").read_text()


def test_groups_of_near_duplicates_are_capped(data: Path, tmp_path: Path) -> None:
    """One group of 5,000 clips; invalid signatures are ignored."""
    retarget.batch(data, tmp_path / "batch", "g1", jobs=1, quality=False)
    signature = json.loads((tmp_path / "batch/manifest.jsonl").read_text().splitlines()[0])["signature"]
    with (tmp_path / "manifest.jsonl").open("w") as manifest:
        manifest.writelines(line(number, signature=signature) for number in range(5_000))
        manifest.writelines(line(number, signature=signature, robot="other") for number in range(9))
        manifest.write(line(6_000, signature="AAAA") + line(6_001, signature="!") + line(6_002))
    page = write_page(tmp_path, tmp_path / "page.html").read_text()
    assert "Near duplicates: 4,999 of 5,012 clips" in page
    assert len(cells(page, "Near duplicates")) == 31 and len(page) < 200_000
    (tmp_path / "manifest.jsonl").write_text(line(1))
    page = write_page(tmp_path, tmp_path / "page.html").read_text()
    assert "Near duplicates: unknown" in page


def test_a_page_replaces_only_a_page(tmp_path: Path) -> None:
    (tmp_path / "manifest.jsonl").write_text(line(1))
    with pytest.raises(retarget.UsageError, match="no HTML page"):
        write_page(tmp_path, tmp_path / "manifest.jsonl")
    assert (tmp_path / "manifest.jsonl").read_text() == line(1)
    write_page(tmp_path, tmp_path / "page.html")
    write_page(tmp_path, tmp_path / "page.html")
