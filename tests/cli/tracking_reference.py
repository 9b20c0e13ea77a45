"""The tracking arrays of a robot CSV computed with MuJoCo, without this project's code: the arrays that
BeyondMimic's and mjlab's csv_to_npz write after replaying the CSV in a simulator.

    tracking_reference.py MODEL.xml MOTION.csv FPS FILE.npz

compares FILE.npz with them and prints the largest differences as JSON. Needs mujoco and numpy."""

import json
import sys

import mujoco
import numpy as np


def slerp(a, b, s):
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    if np.dot(a, b) < 0:
        b = -b
    angle = 2 * np.arctan2(np.linalg.norm(a - b), np.linalg.norm(a + b))
    if angle < 1e-9:
        return a
    return (np.sin((1 - s) * angle) * a + np.sin(s * angle) * b) / np.sin(angle)


def multiply(a, b):
    result = np.zeros(4)
    mujoco.mju_mulQuat(result, a, b)
    return result


def rotation_vector(q):
    if q[0] < 0:
        q = -q
    sine = np.linalg.norm(q[1:])
    return np.zeros(3) if sine < 1e-12 else 2 * np.arctan2(sine, q[0]) * q[1:] / sine


def samples(csv, fps, out_fps=50):
    """Returns root position, root rotation (wxyz) and joints at out_fps, without the end."""
    last = len(csv) - 1
    count = -(-last * out_fps // fps)  # Times strictly before the last frame.
    position, rotation, joints = [], [], []
    for i in range(count):
        frame, rest = divmod(i * fps, out_fps)
        s = rest / out_fps
        a, b = csv[frame], csv[min(frame + 1, last)]
        position.append((1 - s) * a[:3] + s * b[:3])
        rotation.append(slerp(a[[6, 3, 4, 5]], b[[6, 3, 4, 5]], s))
        joints.append((1 - s) * a[7:] + s * b[7:])
    return np.array(position), np.array(rotation), np.array(joints)


def fixed_to(model, bodies):
    """Returns, for each body of the model, the one of `bodies` that it moves with."""
    carrier = {0: None}
    for body in range(1, model.nbody):
        carrier[body] = body if body in bodies else carrier[model.body_parentid[body]]
    return carrier


def reference(model, csv, fps, joint_names, body_names, of_mass, csv_joints):
    dt = 1 / 50
    position, rotation, joints = samples(csv, fps)
    linear = np.gradient(position, dt, axis=0)
    speeds = np.gradient(joints, dt, axis=0)
    middle = [rotation_vector(multiply(b, a * [1, -1, -1, -1])) / (2 * dt)
              for a, b in zip(rotation, rotation[2:])]
    angular = np.array([middle[0], *middle, middle[-1]])
    data = mujoco.MjData(model)
    bodies = [model.body(name).id for name in body_names]
    carrier = fixed_to(model, bodies)
    result = {key: [] for key in ("joint_pos", "joint_vel", "body_pos_w", "body_quat_w",
                                  "body_lin_vel_w", "body_ang_vel_w")}
    order = [csv_joints.index(name) for name in joint_names]
    for i in range(len(position)):
        data.qpos[:3], data.qpos[3:7] = position[i], rotation[i]
        data.qvel[:3] = linear[i]
        unit = rotation[i] / np.linalg.norm(rotation[i])
        mujoco.mju_rotVecQuat(data.qvel[3:6], angular[i], unit * [1, -1, -1, -1])
        for name, value, speed in zip(csv_joints, joints[i], speeds[i]):
            joint = model.joint(name)
            data.qpos[joint.qposadr[0]], data.qvel[joint.dofadr[0]] = value, speed
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        result["joint_pos"].append(joints[i][order])
        result["joint_vel"].append(speeds[i][order])
        result["body_pos_w"].append(data.xpos[bodies].copy())
        result["body_quat_w"].append(data.xquat[bodies].copy())
        lin, ang = [], []
        for body in bodies:
            velocity = np.zeros(6)
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, velocity, 0)
            v, w = velocity[3:], velocity[:3]
            if of_mass:
                parts = [b for b in carrier if carrier[b] == body]
                mass = model.body_mass[parts]
                centre = mass @ data.xipos[parts] / mass.sum()
                v = v + np.cross(w, centre - data.xpos[body])
            lin.append(v)
            ang.append(w)
        result["body_lin_vel_w"].append(lin)
        result["body_ang_vel_w"].append(ang)
    return {key: np.array(value) for key, value in result.items()}


def main():
    model = mujoco.MjModel.from_xml_path(sys.argv[1])
    csv = np.loadtxt(sys.argv[2], delimiter=",")
    found = np.load(sys.argv[4])
    csv_joints = [model.joint(j).name for j in range(model.njnt)
                  if model.jnt_type[j] != mujoco.mjtJoint.mjJNT_FREE]
    of_mass = str(found["flavour"]) == "npz-beyondmimic"
    wanted = reference(model, csv, int(sys.argv[3]), list(found["joint_names"]),
                       list(found["body_names"]), of_mass, csv_joints)
    differences = {}
    for key, value in wanted.items():
        array = found[key].astype(float)
        if array.shape != value.shape:
            differences[key] = f"shape {array.shape} for {value.shape}"
            continue
        if key == "body_quat_w":
            array = array * np.sign((array * value).sum(-1, keepdims=True))
        differences[key] = float(np.abs(array - value).max())
    print(json.dumps(differences))


if __name__ == "__main__":
    main()
