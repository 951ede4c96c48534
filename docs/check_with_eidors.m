% Checks a flat skin's export against EIDORS, in MATLAB or Octave with EIDORS started:
%
%   >> folder = 'disc'; check_with_eidors
%
% `folder` is what `dermatome export SKIN --out disc` wrote. Everything in it counts from 0.
s = load(fullfile(folder, 'skin.mat'));
assert(all(s.nodes(:, 3) == 0), 'EIDORS has no triangles in space: the skin must be flat');
assert(isempty(s.electrode_faces), 'EIDORS has no electrodes inside a flat sheet');

fmdl = eidors_obj('fwd_model', s.skin);
fmdl.nodes = s.nodes(:, 1:2);
fmdl.elems = s.elements + 1;
fmdl.boundary = find_boundary(fmdl.elems);
fmdl.gnd_node = 1;      % differences of electrode potentials do not depend on it
fmdl.solve = @fwd_solve_1st_order;
fmdl.jacobian = @jacobian_adjoint;
fmdl.system_mat = @system_mat_1st_order;
fmdl.normalize_measurements = 0;

touched = [s.electrode_points; s.electrode_edges(:, 1:2); s.electrode_edges(:, [1 3])];
electrodes = max(touched(:, 1)) + 1;
for e = 1:electrodes
  fmdl.electrode(e).nodes = unique(touched(touched(:, 1) == e - 1, 2))' + 1;
  fmdl.electrode(e).z_contact = 1;    % not used by point electrodes
  if ~isempty(s.contact_impedance)
    fmdl.electrode(e).z_contact = s.contact_impedance(e);
  end
end

% Steps in a row with the same drive pair are one EIDORS stimulation.
steps = s.stimulation + 1;
k = 0;
for step = 1:size(steps, 1)
  if step == 1 || any(steps(step, 1:2) ~= steps(step - 1, 1:2))
    k = k + 1;
    fmdl.stimulation(k).stimulation = 'Amp';
    fmdl.stimulation(k).stim_pattern = sparse(steps(step, 1:2), 1, [1 -1], electrodes, 1);
    fmdl.stimulation(k).meas_pattern = sparse(0, electrodes);
  end
  fmdl.stimulation(k).meas_pattern(end + 1, :) = sparse(1, steps(step, 3:4), [1 -1], 1, electrodes);
end

img = mk_image(fmdl, s.conductivity(1));
vh = fwd_solve(img);
% EIDORS' Jacobian is by element; a pixel's conductivity changes its share of each element.
pixel_of_element = sparse(s.pixel_element_element + 1, s.pixel_element_pixel + 1, s.pixel_element_share);
J = calc_jacobian(img) * pixel_of_element;
E = calc_system_mat(img);
S = sparse(s.system_matrix_row + 1, s.system_matrix_col + 1, s.system_matrix_value);

relative = @(a, b) full(max(abs(a(:) - b(:))) / max(abs(b(:))));
fprintf('voltages       %.1e relative difference\n', relative(s.voltages, vh.meas));
fprintf('Jacobian       %.1e\n', relative(s.jacobian, J));
fprintf('system matrix  %.1e\n', relative(S, E.E));
